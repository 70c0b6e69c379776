import { html, nothing } from 'lit-html';
import { repeat as each } from 'lit-html/directives/repeat.js';
import { Job_State, type Job } from '@api/job_pb';
import { jobsApi } from '../api/clients';
import { explain, type Explanation } from '../api/explain';
import { parseLabels } from '../job/job_request';
import { hasEnded } from '../job/job_watch';
import {
  ageWords,
  countWords,
  figure,
  idOf,
  METHOD_WORDS,
  progressShare,
  STATE_WORDS,
  titleOf,
} from '../job/words';
import { Painter, repeat, type Page } from '../ui/dom';
import { emptyState, errorNotice, loadingState } from '../ui/notices';

const POLL_MS = 1500;
const PAGE_SIZE = 50;
const FILTERS: [string, Job_State[]][] = [
  ['all', []],
  ['active', [Job_State.QUEUED, Job_State.RUNNING, Job_State.CANCELLING]],
  ['succeeded', [Job_State.SUCCEEDED]],
  ['failed', [Job_State.FAILED]],
  ['cancelled', [Job_State.CANCELLED]],
];

/** The caller's jobs, newest first, with their state as it is now. */
export function jobsPage(box: HTMLElement): Page {
  const left = new AbortController();
  const painter = new Painter(box, template);
  let jobs: Job[] | undefined;
  let more = false;
  let wanted = PAGE_SIZE;
  let filter = 'all';
  let labelText = '';
  let search = '';
  let error: Explanation | undefined;
  let marked: string[] = [];

  async function ask(): Promise<void> {
    try {
      const answer = await jobsApi.listJobs(
        {
          pageSize: wanted,
          states: FILTERS.find(([name]) => name === filter)?.[1] ?? [],
          labels: parseLabels(labelText) ?? {},
        },
        { signal: left.signal },
      );
      jobs = answer.jobs;
      more = answer.nextPageToken !== '' && wanted < 1000;
      error = undefined;
    } catch (cause) {
      if (left.signal.aborted) return;
      error = explain(cause);
    }
    painter.later();
  }

  function filterBy(name: string): void {
    filter = name;
    jobs = undefined;
    painter.now();
    void ask();
  }

  function mark(name: string, on: boolean): void {
    marked = on ? [...marked, name].slice(-2) : marked.filter((other) => other !== name);
    painter.now();
  }

  function template() {
    const [a, b] = marked;
    return html`<div class="page-head">
        <h1>Jobs</h1>
        <div class="actions">
          ${a && b
            ? html`<a class="button" href="#/compare/${idOf(a)}/${idOf(b)}">Compare the two</a>`
            : html`<span class="quiet">${a ? 'Tick another one to compare' : ''}</span>`}
          <a class="button primary" href="#/new">New job</a>
        </div>
      </div>
      <div class="filters" role="search">
        <div class="segments" role="group" aria-label="State">
          ${FILTERS.map(
            ([name]) => html`<button
              aria-pressed=${filter === name ? 'true' : 'false'}
              @click=${() => filterBy(name)}
            >
              ${name}
            </button>`,
          )}
        </div>
        <input
          type="search"
          aria-label="Name"
          placeholder="Name"
          .value=${search}
          @input=${(event: InputEvent) => {
            search = (event.target as HTMLInputElement).value;
            painter.now();
          }}
        />
        <input
          type="search"
          aria-label="Labels"
          placeholder="Labels: key=value"
          .value=${labelText}
          @change=${(event: InputEvent) => {
            labelText = (event.target as HTMLInputElement).value;
            void ask();
          }}
        />
      </div>
      ${errorNotice(error)} ${list()}`;
  }

  function list() {
    if (!jobs) return error ? nothing : loadingState('Loading jobs');
    const shown = jobs.filter((job) => titleOf(job).toLowerCase().includes(search.toLowerCase()));
    if (shown.length === 0) {
      return filter === 'all' && labelText === '' && search === ''
        ? emptyState(
            'No jobs yet',
            html`Drop a mesh anywhere on this page, or <a href="#/new">choose one with options</a>.`,
          )
        : emptyState('None like that', 'No job matches the filters.');
    }
    const now = Date.now();
    return html`<table class="jobs">
        <thead>
          <tr>
            <th><span class="visually-hidden">Compare</span></th>
            <th>Job</th>
            <th>State</th>
            <th class="number">Samples</th>
            <th>Method</th>
            <th class="number">Variation</th>
            <th class="number">Started</th>
          </tr>
        </thead>
        <tbody>
          ${each(
            shown,
            (job) => job.name,
            (job) => row(job, now),
          )}
        </tbody>
      </table>
      ${more
        ? html`<button
            @click=${() => {
              wanted = Math.min(1000, wanted + 2 * PAGE_SIZE);
              void ask();
            }}
          >
            Show more
          </button>`
        : nothing}`;
  }

  function row(job: Job, now: number) {
    const state = STATE_WORDS[job.state];
    const cv = job.result?.capacityCv ?? job.progress?.capacityCv;
    const labels = Object.entries(job.labels);
    return html`<tr>
      <td>
        <input
          type="checkbox"
          aria-label="Compare ${titleOf(job)}"
          .checked=${marked.includes(job.name)}
          @change=${(e: Event) => mark(job.name, (e.target as HTMLInputElement).checked)}
        />
      </td>
      <td class="title">
        <a href="#/jobs/${idOf(job.name)}">${titleOf(job)}</a>
        ${labels.map(([key, value]) => html`<span class="label">${key}=${value}</span>`)}
      </td>
      <td>
        <span class="state ${state}">${state}</span>
        ${hasEnded(job.state)
          ? job.resultCached
            ? html`<span class="quiet">stored result</span>`
            : nothing
          : html`<progress
              aria-label="Progress of ${titleOf(job)}"
              max="1"
              .value=${progressShare(job)}
            ></progress>`}
        ${job.queuePosition > 0 ? html`<span class="quiet">${job.queuePosition} ahead</span>` : nothing}
      </td>
      <td class="number">${countWords(job.effectiveOptions?.sampleCount ?? 0n)}</td>
      <td>${METHOD_WORDS[job.effectiveOptions?.method ?? 0]}</td>
      <td class="number">${cv ? figure(cv) : '–'}</td>
      <td class="number">${ageWords(job.createTime, now)}</td>
    </tr>`;
  }

  painter.now();
  void repeat(ask, POLL_MS, left.signal);
  return {
    title: 'Jobs',
    leave() {
      left.abort();
      painter.stop();
    },
  };
}
