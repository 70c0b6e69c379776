import { html, nothing, svg } from 'lit-html';
import type { PhaseDurations } from '@api/job_pb';
import { durationWords } from '../job/words';
import { seconds } from '../job/run_history';

/** Where the time went, as one bar and its legend. */
export function phasesPanel(durations: PhaseDurations | undefined) {
  if (!durations) return nothing;
  const phases: [string, number][] = [
    ['queue', seconds(durations.queueDuration)],
    ['decode', seconds(durations.decodeDuration)],
    ['prepare', seconds(durations.prepareDuration)],
    ['initialise', seconds(durations.initializeDuration)],
    ['relax', seconds(durations.optimizeDuration)],
  ];
  const total = phases.reduce((sum, [, time]) => sum + time, 0) || 1;
  let start = 0;
  return html`<h3>Phases</h3>
    <svg class="phases" viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true">
      ${phases.map(([name, time]) => {
        const x = start;
        start += (100 * time) / total;
        return svg`<rect class=${name} x=${x} width=${(100 * time) / total} height="4"></rect>`;
      })}
    </svg>
    <ul class="phase-legend">
      ${phases.map(
        ([name, time]) => html`<li><span class="swatch ${name}"></span>${name} ${durationWords(time)}</li>`,
      )}
    </ul>`;
}
