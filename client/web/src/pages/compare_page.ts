import { html, nothing } from 'lit-html';
import { Job_State, type Job } from '@api/job_pb';
import type { AnalyzeJobResponse } from '@api/sampling_service_pb';
import { jobsApi } from '../api/clients';
import { explain, type Explanation } from '../api/explain';
import { hasEnded, JobWatch } from '../job/job_watch';
import { QUALITY_FIGURES } from '../job/quality_figures';
import { seconds, type RunHistory } from '../job/run_history';
import { countWords, durationWords, idOf, METHOD_WORDS, STATE_WORDS, titleOf } from '../job/words';
import { Chart, onOneAxis } from '../charts/chart';
import { find, Painter, wait, type Page } from '../ui/dom';
import { errorNotice } from '../ui/notices';
import { ViewPanel } from '../panels/view_panel';

interface Side {
  name: string;
  job?: Job;
  report?: AnalyzeJobResponse;
  history?: RunHistory;
  view: ViewPanel;
  watch: JobWatch;
}

/** Two jobs side by side: views that turn together, one chart, one table. */
export function comparePage(box: HTMLElement, nameA: string, nameB: string): Page {
  const left = new AbortController();
  let error: Explanation | undefined;
  box.innerHTML = `<div class="page-head"><h1>Compare</h1></div>
    <div class="compare-views">
      <section class="card view-card" aria-label="First job"></section>
      <section class="card view-card" aria-label="Second job"></section>
    </div>
    <div class="job-below">
      <section class="card compare-table" aria-label="Figures"></section>
      <section class="card" aria-label="Variation"><h2>Variation of capacities</h2>
        <div class="chart variation"></div></section>
    </div>`;
  const [boxA, boxB] = box.querySelectorAll<HTMLElement>('.view-card');
  const table = new Painter(find(box, '.compare-table'), template);
  const chart = new Chart(find(box, '.chart'), {
    title: 'Variation of capacities by alternation',
    xLabel: 'alternation',
    logarithmic: true,
    series: [
      { label: 'first', colour: '--chart-1' },
      { label: 'second', colour: '--chart-2' },
    ],
  });

  function sideOf(name: string, panel: HTMLElement): Side {
    const view = new ViewPanel(panel, left.signal);
    const watch = new JobWatch(
      {
        open: (afterSequence, signal) =>
          jobsApi.watchJob({ name, afterSequence, previewSampleCount: view.previewPoints }, { signal }),
        wait,
        random: Math.random,
      },
      {
        onJob(job) {
          side.job = job;
          view.setJob(job);
          if (job.state === Job_State.SUCCEEDED && !side.report) void measure(side);
          table.later();
        },
        onProgress(history) {
          side.history = history;
          drawChart();
        },
        onPreview: (preview) => view.showPreview(preview),
        onConnection(connection) {
          if (connection.state === 'failed') error = connection.why;
          table.later();
        },
      },
    );
    const side: Side = { name, view, watch };
    return side;
  }

  const sides = [sideOf(nameA, boxA ?? box), sideOf(nameB, boxB ?? box)];
  const [a, b] = sides;
  if (a?.view.stage && b?.view.stage) a.view.stage.link(b.view.stage);

  async function measure(side: Side): Promise<void> {
    try {
      side.report = await jobsApi.analyzeJob({ name: side.name }, { signal: left.signal });
    } catch (cause) {
      if (!left.signal.aborted) error = explain(cause);
    }
    table.later();
  }

  function drawChart(): void {
    const { x, ys } = onOneAxis(
      sides.map(({ history }) => ({
        x: history?.iterations ?? [],
        y: history?.capacityCvs ?? [],
      })),
    );
    // A logarithm has no place for zero.
    chart.setData(x, ys.map((values) => values.map((v) => v || null)));
  }

  function template() {
    const row = (label: string, words: (side: Side) => unknown) =>
      html`<tr>
        <th scope="row">${label}</th>
        ${sides.map((side) => html`<td class="number">${words(side)}</td>`)}
      </tr>`;
    const ofJob = (words: (job: Job) => unknown) => (side: Side) => (side.job ? words(side.job) : '…');
    return html`<h2>Figures</h2>
      ${errorNotice(error)}
      <div class="scroll" tabindex="0" role="region" aria-label="Figures of both jobs">
        <table class="quality">
          <thead>
            <tr>
              <th>Figure</th>
              ${sides.map(
                (side) => html`<th class="number">
                  <a href="#/jobs/${idOf(side.name)}">${side.job ? titleOf(side.job) : '…'}</a>
                </th>`,
              )}
            </tr>
          </thead>
          <tbody>
            ${row('State', ofJob((job) => STATE_WORDS[job.state]))}
            ${row('Method', ofJob((job) => METHOD_WORDS[job.effectiveOptions?.method ?? 0]))}
            ${row('Samples', ofJob((job) => countWords(job.effectiveOptions?.sampleCount ?? 0n)))}
            ${row('Alternations', ofJob((job) => job.result?.iterationCount ?? job.progress?.iteration ?? 0))}
            ${row(
              'Computing',
              ofJob((job) => durationWords(seconds(job.result?.durations?.totalDuration))),
            )}
            ${QUALITY_FIGURES.map((figure) =>
              row(figure.label, ({ job, report }) => {
                const value = report ? figure.value(report) : undefined;
                if (value !== undefined) return figure.words(value);
                return report || (job && hasEnded(job.state)) ? '–' : '…';
              }),
            )}
          </tbody>
        </table>
      </div>
      ${sameMesh() ? nothing : html`<p class="notice warn">The two jobs are on different meshes.</p>`}`;
  }

  function sameMesh(): boolean {
    return !a?.job || !b?.job || a.job.mesh === b.job.mesh;
  }

  table.now();
  for (const side of sides) void side.watch.run();
  return {
    title: 'Compare',
    leave() {
      left.abort();
      table.stop();
      chart.destroy();
      for (const side of sides) {
        side.watch.stop();
        side.view.destroy();
      }
    },
  };
}
