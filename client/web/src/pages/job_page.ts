import { create } from '@bufbuild/protobuf';
import { html, nothing } from 'lit-html';
import { Job_State, SamplingOptionsSchema, type Job } from '@api/job_pb';
import { jobsApi } from '../api/clients';
import { explain, explainStatus, type Explanation } from '../api/explain';
import { JobWatch, hasEnded, type Connection } from '../job/job_watch';
import {
  countWords,
  densityWords,
  durationWords,
  idOf,
  METHOD_WORDS,
  PHASE_WORDS,
  progressShare,
  STATE_WORDS,
  TERMINATION_WORDS,
  titleOf,
} from '../job/words';
import { seconds } from '../job/run_history';
import { find, Painter, wait, type Page } from '../ui/dom';
import { errorNotice, loadingState } from '../ui/notices';
import { downloadsMenu } from '../panels/downloads_menu';
import { phasesPanel } from '../panels/phases_panel';
import { QualityPanel } from '../panels/quality_panel';
import { RunCharts } from '../panels/run_charts';
import { ViewPanel } from '../panels/view_panel';

/** One job: live while it runs, judged when it has ended. */
export function jobPage(box: HTMLElement, name: string): Page {
  const left = new AbortController();
  let job: Job | undefined;
  let connection: Connection = { state: 'connecting' };
  let error: Explanation | undefined;
  let copied = false;

  box.innerHTML = `<div class="job-head"></div>
    <div class="job-grid">
      <section class="card view-card" aria-label="Points on the surface"></section>
      <div class="job-side">
        <section class="card status-card" aria-label="Progress"></section>
        <section class="card charts-card" aria-label="Charts"></section>
      </div>
    </div>
    <div class="job-below">
      <section class="card quality-card" aria-label="Quality"></section>
      <section class="card facts-card" aria-label="Options and surface"></section>
    </div>`;
  const head = new Painter(find(box, '.job-head'), headTemplate);
  const status = new Painter(find(box, '.status-card'), statusTemplate);
  const facts = new Painter(find(box, '.facts-card'), factsTemplate);
  const charts = new RunCharts(find(box, '.charts-card'));
  const view = new ViewPanel(find(box, '.view-card'), left.signal);
  const quality = new QualityPanel(find(box, '.quality-card'), left.signal);

  const watch = new JobWatch(
    {
      open: (afterSequence, signal) =>
        jobsApi.watchJob({ name, afterSequence, previewSampleCount: view.previewPoints }, { signal }),
      wait,
      random: Math.random,
    },
    {
      onJob(now) {
        job = now;
        document.title = `${STATE_WORDS[now.state]} · ${titleOf(now)} · ccst`;
        view.setJob(now);
        quality.setJob(now);
        facts.later();
        head.later();
        status.later();
      },
      onProgress(history) {
        if (job && history.latest && !hasEnded(job.state)) job.progress = history.latest;
        charts.show(history);
        status.later();
      },
      onPreview: (preview) => view.showPreview(preview),
      onConnection(now) {
        connection = now;
        head.later();
        status.later();
      },
    },
  );

  async function act(call: () => Promise<unknown>): Promise<boolean> {
    try {
      await call();
      error = undefined;
    } catch (cause) {
      error = explain(cause);
    }
    head.later();
    return error === undefined;
  }

  const cancel = () => void act(() => jobsApi.cancelJob({ name }));
  const remove = () =>
    void act(() => jobsApi.deleteJob({ name })).then((gone) => {
      if (gone) location.hash = '#/jobs';
    });
  const copyLink = () =>
    void act(() => navigator.clipboard.writeText(location.href)).then((done) => {
      copied = done;
      head.later();
    });

  function headTemplate() {
    const state = job ? STATE_WORDS[job.state] : '';
    return html`<div class="page-head">
        <div>
          <p class="crumbs"><a href="#/jobs">Jobs</a> / <code>${idOf(name).slice(0, 8)}</code></p>
          <h1>
            ${job ? titleOf(job) : 'Job'} ${job ? html`<span class="state ${state}">${state}</span>` : nothing}
          </h1>
        </div>
        <div class="actions">
          ${job && !hasEnded(job.state)
            ? html`<button class="danger" ?disabled=${job.state === Job_State.CANCELLING} @click=${cancel}>
                Cancel
              </button>`
            : nothing}
          ${job?.state === Job_State.SUCCEEDED ? downloadsMenu(job, act) : nothing}
          <button @click=${copyLink}>${copied ? 'Copied' : 'Copy link'}</button>
          ${job && hasEnded(job.state)
            ? html`<a class="button" href="#/new/${idOf(name)}">Run again…</a>
                <button @click=${remove}>Delete</button>`
            : nothing}
        </div>
      </div>
      ${errorNotice(error)} ${connectionNotice()}
      ${job?.error ? errorNotice(explainStatus(job.error)) : nothing}`;
  }

  function connectionNotice() {
    if (connection.state === 'failed') return errorNotice(connection.why);
    if (connection.state !== 'reconnecting') return nothing;
    return html`<div class="notice warn" role="status">
      <strong>Reconnecting…</strong>
      <p>${connection.why.title}. What was shown stays; the page goes on where it was.</p>
    </div>`;
  }

  function statusTemplate() {
    if (!job) {
      return connection.state === 'failed' ? html`<p class="quiet">Nothing to show.</p>` : loadingState('Loading the job');
    }
    const { progress, result } = job;
    const phase = result
      ? TERMINATION_WORDS[result.terminationReason]
      : job.state === Job_State.QUEUED
        ? `${job.queuePosition} jobs ahead`
        : hasEnded(job.state)
          ? STATE_WORDS[job.state]
          : PHASE_WORDS[progress?.phase ?? 0];
    const alternations = result?.iterationCount ?? progress?.iteration ?? 0;
    return html`<h2>${result ? 'Result' : 'Progress'}</h2>
      <progress aria-label="Progress" max="1" .value=${progressShare(job)}></progress>
      <p class="phase" role="status">
        ${phase}${result || !progress ? nothing : html`, alternation ${progress.iteration} of at most ${progress.iterationLimit}`}
      </p>
      <dl class="tiles">
        <div><dt>Samples</dt><dd>${countWords(job.effectiveOptions?.sampleCount ?? 0n)}</dd></div>
        <div><dt>Alternations</dt><dd>${alternations}</dd></div>
        <div>
          <dt>Variation</dt>
          <dd>${percent(result?.capacityCv ?? progress?.capacityCv)}</dd>
        </div>
        <div>
          <dt>Computing</dt>
          <dd>
            ${durationWords(seconds(result?.durations?.totalDuration ?? progress?.elapsedDuration))}
          </dd>
        </div>
      </dl>
      ${phasesPanel(result?.durations)}
      ${result?.warnings.map((warning) => html`<p class="notice warn">${warning}</p>`)}`;
  }

  function factsTemplate() {
    if (!job) return html``;
    const options = job.effectiveOptions ?? create(SamplingOptionsSchema);
    const surface = job.result?.surface;
    const rows: [string, unknown][] = [
      ['Method', METHOD_WORDS[options.method]],
      ['Density', densityWords(options)],
      ['Seed', String(options.seed ?? 0n)],
      ['Most alternations', options.maxIterations],
      ['Tolerance', options.relativeTolerance],
      [
        'Crease angle',
        options.creaseAngleRadians === undefined
          ? 'off'
          : `${((options.creaseAngleRadians * 180) / Math.PI).toFixed(1)}°`,
      ],
      ['Mesh', html`<code>${idOf(job.mesh).slice(0, 12)}</code>`],
      ...Object.entries(job.labels).map(([key, value]): [string, unknown] => [`Label ${key}`, value]),
    ];
    if (surface) {
      rows.push(
        ['Faces', countWords(surface.faceCount)],
        ['Area', Number(surface.surfaceArea.toPrecision(5))],
        ['Components', String(surface.componentCount)],
        ['Boundary loops', String(surface.boundaryLoopCount)],
        ['Euler characteristic', String(surface.eulerCharacteristic)],
      );
    }
    return html`<h2>Options and surface</h2>
      <dl class="facts">${rows.map(([term, value]) => html`<div><dt>${term}</dt><dd>${value}</dd></div>`)}</dl>
      ${job.result?.samplesDigest
        ? html`<p class="quiet digest">Digest of the samples <code>${job.result.samplesDigest.sha256}</code></p>`
        : nothing}`;
  }

  head.now();
  status.now();
  void watch.run();
  return {
    title: 'Job',
    leave() {
      left.abort();
      watch.stop();
      for (const painter of [head, status, facts]) painter.stop();
      charts.destroy();
      view.destroy();
      quality.destroy();
    },
  };
}

function percent(share: number | undefined): string {
  return share ? `${(100 * share).toFixed(2)} %` : '–';
}
