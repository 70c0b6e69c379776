import { html, nothing } from 'lit-html';
import { Job_State, type Job } from '@api/job_pb';
import type { SamplePreview } from '@api/sampling_service_pb';
import { explain } from '../api/explain';
import { readMeshBytes, readSampleMesh, readSamples } from '../job/read_results';
import { countWords } from '../job/words';
import { decodeSurface } from '../mesh/mesh_tasks';
import { find, Painter } from '../ui/dom';
import { COLOUR_WORDS, type ColourBy, type Colouring } from '../view/colouring';
import { JobView, type Layers } from '../view/job_view';
import { GRADIENT } from '../view/colour_map';

/** The 3-D view with what one can choose about it. */
export class ViewPanel {
  private readonly view: JobView | undefined;
  private readonly tools: Painter;
  private readonly layers: Layers = { surface: true, points: true, mesh: true };
  private by: ColourBy = 'none';
  private legend: Colouring | undefined;
  private message = '';
  private hasResult = false;
  private hasMesh = false;
  private surfaceAsked = false;
  private resultAsked = false;

  constructor(
    private readonly box: HTMLElement,
    private readonly signal: AbortSignal,
  ) {
    box.innerHTML = `<div class="view"></div><div class="view-tools"></div>`;
    this.tools = new Painter(find(box, '.view-tools'), () => this.template());
    try {
      this.view = new JobView(find(box, '.view'));
      this.view.stage.describe('The surface, and no points yet');
      document.addEventListener('themechange', this.restyle);
    } catch {
      this.message = 'This browser draws no 3-D (WebGL). Charts and downloads work all the same.';
    }
    this.tools.now();
  }

  get previewPoints(): number {
    return this.view?.previewPoints ?? 0;
  }

  /** The view itself, to link with another one's. */
  get stage() {
    return this.view?.stage;
  }

  setJob(job: Job): void {
    if (!this.view) return;
    if (!this.surfaceAsked) {
      this.surfaceAsked = true;
      void this.loadSurface(job);
    }
    if (job.state === Job_State.SUCCEEDED && !this.resultAsked) {
      this.resultAsked = true;
      void this.loadResult(job);
    }
  }

  showPreview(preview: SamplePreview): void {
    if (!this.view || this.hasResult) return;
    performance.mark('ccst-preview-received');
    const positions = Float32Array.from(preview.positions);
    this.box.dataset['previews'] = String(Number(this.box.dataset['previews'] ?? 0) + 1);
    this.view.showPreview(positions, () => performance.mark('ccst-preview-drawn'));
    this.describe(`${countWords(positions.length / 3)} points after ${preview.iteration} alternations`);
  }

  destroy(): void {
    document.removeEventListener('themechange', this.restyle);
    this.tools.stop();
    this.view?.dispose();
  }

  private readonly restyle = (): void => this.view?.restyle();

  private async loadSurface(job: Job): Promise<void> {
    try {
      const surface = await decodeSurface(await readMeshBytes(job.mesh, this.signal));
      if (!this.signal.aborted) this.view?.setSurface(surface);
    } catch (error) {
      if (!this.signal.aborted) this.say(`Without its surface: ${explain(error).title}`);
    }
  }

  private async loadResult(job: Job): Promise<void> {
    const { result } = job;
    if (!result) return;
    try {
      const count = Number(result.sampleCount);
      this.say('Loading the samples…');
      const samples = await readSamples(job.name, count, this.signal, (share) =>
        this.say(`Loading the samples: ${Math.round(100 * share)} %`),
      );
      const triangles = await readSampleMesh(
        job.name,
        Number(result.sampleMeshFaceCount),
        this.signal,
      );
      if (this.signal.aborted) return;
      this.hasResult = true;
      this.hasMesh = triangles.length > 0;
      const area = result.surface?.surfaceArea ?? 0;
      this.view?.showResult({ samples, triangles, area }, () => performance.mark('ccst-result-drawn'));
      this.box.dataset['result'] = 'shown';
      this.say('');
      this.describe(
        `${countWords(count)} samples${this.hasMesh ? ` and ${countWords(triangles.length / 3)} triangles over them` : ''}`,
      );
    } catch (error) {
      if (!this.signal.aborted) this.say(`${explain(error).title}. ${explain(error).advice}`);
    }
  }

  private say(message: string): void {
    this.message = message;
    this.tools.later();
  }

  private describe(what: string): void {
    this.view?.stage.describe(`The surface with ${what}. Arrow keys turn it, plus and minus zoom.`);
    find(this.box, '.view').dataset['points'] = String(this.view?.shownPoints ?? 0);
  }

  private choose(by: ColourBy): void {
    this.by = by;
    this.legend = this.view?.colourBy(by);
    this.tools.now();
  }

  private toggle(layer: keyof Layers): void {
    this.layers[layer] = !this.layers[layer];
    this.view?.show(this.layers);
    this.tools.now();
  }

  private template() {
    const layer = (name: keyof Layers, words: string, there: boolean) =>
      html`<button
        aria-pressed=${this.layers[name] ? 'true' : 'false'}
        ?disabled=${!there}
        @click=${() => this.toggle(name)}
      >
        ${words}
      </button>`;
    const shown = this.view?.shownPoints ?? 0;
    return html`<div class="segments" role="group" aria-label="Layers">
        ${layer('surface', 'Surface', true)} ${layer('points', 'Points', true)}
        ${layer('mesh', 'Mesh', this.hasMesh)}
      </div>
      <label class="inline">
        <span>Colour</span>
        <select
          ?disabled=${!this.hasResult}
          .value=${this.by}
          @change=${(event: Event) =>
            this.choose((event.target as HTMLSelectElement).value as ColourBy)}
        >
          ${Object.entries(COLOUR_WORDS).map(
            ([value, words]) =>
              html`<option value=${value} ?disabled=${value === 'capacity' && !this.hasMesh}>
                ${words}
              </option>`,
          )}
        </select>
      </label>
      ${this.legend
        ? html`<div class="legend">
            <span>${this.legend.lowWords}</span
            ><span class="ramp" .style=${`background: ${GRADIENT}`}></span
            ><span>${this.legend.highWords}</span>
            <span class="quiet">${this.legend.unit}</span>
          </div>`
        : nothing}
      <p class="quiet view-message" role="status">${this.message || (shown ? '' : 'Points appear as they are placed.')}</p>`;
  }
}
