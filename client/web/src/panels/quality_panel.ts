import { html, nothing } from 'lit-html';
import { Job_State, type Job } from '@api/job_pb';
import { AnalyzeJobResponseSchema, type AnalyzeJobResponse } from '@api/sampling_service_pb';
import { jobsApi } from '../api/clients';
import { explain, type Explanation } from '../api/explain';
import { Chart, onOneAxis } from '../charts/chart';
import { curvesOf, curveWords } from '../job/curves';
import { QUALITY_FIGURES } from '../job/quality_figures';
import {
  analyzeWhenEnded,
  canHaveReferences,
  ensureReference,
  findReferences,
  REFERENCE_METHODS,
} from '../job/reference_jobs';
import { idOf } from '../job/words';
import { find, Painter } from '../ui/dom';
import { errorNotice, loadingState } from '../ui/notices';

interface Column {
  title: string;
  job: Job;
  report: AnalyzeJobResponse | undefined;
}

/** How good the samples are, beside those of other methods where asked for. */
export class QualityPanel {
  private readonly table: Painter;
  private job: Job | undefined;
  private columns: Column[] = [];
  private charts: Chart[] = [];
  private error: Explanation | undefined;
  private starting = false;

  constructor(
    private readonly box: HTMLElement,
    private readonly signal: AbortSignal,
  ) {
    box.innerHTML = `<div class="quality-table"></div><div class="curves"></div>`;
    this.table = new Painter(find(box, '.quality-table'), () => this.template());
    this.table.now();
  }

  setJob(job: Job): void {
    const first = this.job?.state !== Job_State.SUCCEEDED && job.state === Job_State.SUCCEEDED;
    this.job = job;
    if (first) void this.load(job);
    this.table.later();
  }

  destroy(): void {
    this.table.stop();
    for (const chart of this.charts) chart.destroy();
  }

  private async load(job: Job): Promise<void> {
    await this.attempt(async () => {
      const own: Column = { title: 'This job', job, report: undefined };
      this.columns = [own];
      own.report = await jobsApi.analyzeJob({ name: job.name }, { signal: this.signal });
      this.drawCurves();
      this.table.later();
      const found = await findReferences(job, this.signal);
      await this.attemptEach(async ({ method, title }) => {
        const reference = found.get(method);
        if (reference) await this.addColumn(title, reference);
      });
    });
  }

  private async addReferences(): Promise<void> {
    const { job } = this;
    if (!job) return;
    this.starting = true;
    this.error = undefined;
    this.table.now();
    await this.attemptEach(async ({ method, title }) => {
      if (this.columns.some((c) => c.title === title)) return;
      await this.addColumn(title, await ensureReference(job, method, title, this.signal));
    });
    this.starting = false;
    this.table.later();
  }

  private async addColumn(title: string, job: Job): Promise<void> {
    const column: Column = { title, job, report: undefined };
    this.columns.push(column);
    const order = ['This job', ...REFERENCE_METHODS.map((r) => r.title)];
    this.columns.sort((a, b) => order.indexOf(a.title) - order.indexOf(b.title));
    this.table.later();
    try {
      column.report = await analyzeWhenEnded(job, this.signal);
    } catch (error) {
      // Without it the button is there again, for another try.
      this.columns = this.columns.filter((c) => c !== column);
      throw error;
    }
    this.drawCurves();
    this.table.later();
  }

  /** Works on all methods at once; one that fails is told of and does not stop the other. */
  private async attemptEach(work: (reference: (typeof REFERENCE_METHODS)[number]) => Promise<void>): Promise<void> {
    await Promise.all(REFERENCE_METHODS.map((reference) => this.attempt(() => work(reference))));
  }

  private async attempt(work: () => Promise<unknown>): Promise<void> {
    try {
      await work();
    } catch (error) {
      if (this.signal.aborted) return;
      this.error = explain(error);
    }
    this.table.later();
  }

  private drawCurves(): void {
    for (const chart of this.charts) chart.destroy();
    this.charts = [];
    const box = find(this.box, '.curves');
    box.replaceChildren();
    const colours = ['--chart-1', '--chart-2', '--chart-3'];
    const shown = this.columns.flatMap(({ title, report }) =>
      report ? [{ title, curves: curvesOf(AnalyzeJobResponseSchema, report) }] : [],
    );
    for (const name of new Set(shown.flatMap((s) => s.curves.map((c) => c.name)))) {
      const having = shown.filter((s) => s.curves.some((c) => c.name === name));
      const figureBox = document.createElement('figure');
      const { title, axis } = curveWords(name);
      figureBox.innerHTML = `<figcaption></figcaption><div class="chart curve"></div>`;
      find(figureBox, 'figcaption').textContent = title;
      box.append(figureBox);
      const chart = new Chart(find(figureBox, '.chart'), {
        title,
        xLabel: axis,
        series: having.map((s, i) => ({ label: s.title, colour: colours[i] ?? '--chart-1' })),
      });
      const curves = having.flatMap((s) => s.curves.filter((c) => c.name === name));
      const { x, ys } = onOneAxis(curves);
      chart.setData(x, ys);
      this.charts.push(chart);
    }
  }

  private template() {
    const { job } = this;
    if (job?.state !== Job_State.SUCCEEDED) {
      return html`<h2>Quality</h2>
        <p class="quiet">Measured when the job has succeeded.</p>`;
    }
    const own = this.columns[0]?.report;
    return html`<div class="panel-head">
        <h2>Quality</h2>
        ${this.columns.length <= REFERENCE_METHODS.length && own
          ? html`<button
              ?disabled=${this.starting || !canHaveReferences(job)}
              title=${canHaveReferences(job) ? '' : 'The image of the density is not kept'}
              @click=${() => void this.addReferences()}
            >
              Compare with Poisson disk and white noise
            </button>`
          : nothing}
      </div>
      ${errorNotice(this.error)} ${own || this.error ? nothing : loadingState('Measuring')}
      ${own ? this.figures() : nothing}`;
  }

  private figures() {
    return html`<div class="scroll" tabindex="0" role="region" aria-label="Quality figures">
      <table class="quality">
        <thead>
          <tr>
            <th>Figure</th>
            ${this.columns.map(
              (c) => html`<th class="number">
                ${c.title === 'This job' ? c.title : html`<a href="#/jobs/${idOf(c.job.name)}">${c.title}</a>`}
              </th>`,
            )}
          </tr>
        </thead>
        <tbody>
          ${QUALITY_FIGURES.map((row) => {
            const values = this.columns.map((c) => (c.report ? row.value(c.report) : undefined));
            const known = values.filter((v) => v !== undefined);
            const best = row.better === 'larger' ? Math.max(...known) : Math.min(...known);
            return html`<tr>
              <th scope="row">${row.label}<span class="quiet help">${row.help}</span></th>
              ${values.map(
                (v, i) => html`<td class="number ${known.length > 1 && v === best ? 'best' : ''}">
                  ${v !== undefined ? row.words(v) : this.columns[i]?.report ? '–' : '…'}
                </td>`,
              )}
            </tr>`;
          })}
        </tbody>
      </table>
    </div>`;
  }
}
