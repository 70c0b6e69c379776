import { html, nothing, render } from 'lit-html';
import { serverApi } from './api/clients';
import { explain, type Explanation } from './api/explain';
import { currentToken } from './api/token';
import { startFromDrop } from './job/start_job';
import { idOf } from './job/words';
import { warmMeshWorker } from './mesh/mesh_tasks';
import { explainFile } from './mesh/explain_file';
import { comparePage } from './pages/compare_page';
import { jobPage } from './pages/job_page';
import { jobsPage } from './pages/jobs_page';
import { newJobPage } from './pages/new_job_page';
import { find, repeat, type Page } from './ui/dom';
import { errorNotice } from './ui/notices';
import { currentTheme, nextTheme } from './ui/theme';
import { openTokenDialog } from './ui/token_dialog';

const SERVER_EVERY_MS = 5000;

/** The frame around every page: navigation, state of the server, dropping files anywhere. */
export class Shell {
  private page: Page | undefined;
  private server: { version: string; load: string } | { error: Explanation } | undefined;
  private dropState: { file: string } | { error: Explanation } | undefined;

  constructor(private readonly root: HTMLElement) {}

  start(): void {
    this.root.replaceChildren();
    this.draw();
    addEventListener('hashchange', () => this.open());
    document.addEventListener('themechange', () => this.draw());
    this.acceptDrops();
    this.open();
    void repeat(() => this.askServer(), SERVER_EVERY_MS, new AbortController().signal);
    warmMeshWorker();
  }

  private open(): void {
    const [, place = 'jobs', first = '', second = ''] = location.hash.split('/');
    this.page?.leave();
    const box = document.createElement('div');
    find(this.root, 'main').replaceChildren(box);
    if (place === 'jobs' && first) this.page = jobPage(box, `jobs/${first}`);
    else if (place === 'new') this.page = newJobPage(box, first);
    else if (place === 'compare') this.page = comparePage(box, `jobs/${first}`, `jobs/${second}`);
    else this.page = jobsPage(box);
    document.title = `${this.page.title} · ccst`;
    this.draw();
  }

  private async askServer(): Promise<void> {
    try {
      const { serverVersion, load } = await serverApi.getServerInfo({}, { timeoutMs: 4000 });
      const { runningJobCount = 0, queuedJobCount = 0 } = load ?? {};
      this.server = {
        version: serverVersion,
        load: `${runningJobCount} running, ${queuedJobCount} queued`,
      };
    } catch (error) {
      this.server = { error: explain(error) };
    }
    this.draw();
  }

  private draw(): void {
    const place = location.hash.split('/')[1] || 'jobs';
    const link = (to: string, text: string) =>
      html`<a href="#/${to}" aria-current=${place === to ? 'page' : nothing}>${text}</a>`;
    render(
      html`<a class="skip" href="#content" @click=${skipToContent}>Skip to the content</a>
        <header class="bar">
          <a class="brand" href="#/jobs"><span class="dots" aria-hidden="true"></span>ccst</a>
          <nav aria-label="Pages">${link('jobs', 'Jobs')} ${link('new', 'New job')}</nav>
          <div class="server" role="status">${this.serverWords()}</div>
          <button @click=${() => openTokenDialog(() => this.reload())}>
            ${currentToken() === null ? 'Token' : 'Token ✓'}
          </button>
          <button @click=${() => nextTheme()}>
            Theme: ${currentTheme()}
          </button>
        </header>
        ${this.dropNotice()}
        <main id="content" tabindex="-1"></main>`,
      this.root,
    );
  }

  private serverWords() {
    if (!this.server) return html`<span class="lamp"></span>connecting…`;
    if ('error' in this.server) {
      const { title, advice } = this.server.error;
      return html`<span class="lamp bad"></span><span title=${advice}>${title}</span>`;
    }
    return html`<span class="lamp good"></span>server ${this.server.version}
      <span class="quiet">· ${this.server.load}</span>`;
  }

  private dropNotice() {
    if (!this.dropState) return nothing;
    if ('file' in this.dropState) {
      return html`<div class="notice" role="status">Sending ${this.dropState.file}…</div>`;
    }
    return html`<div class="dismissable">
      ${errorNotice(this.dropState.error)}
      <button
        @click=${() => {
          this.dropState = undefined;
          this.draw();
        }}
      >
        Dismiss
      </button>
    </div>`;
  }

  private reload(): void {
    void this.askServer();
    this.open();
  }

  private acceptDrops(): void {
    const over = (on: boolean) => document.body.classList.toggle('dropping', on);
    addEventListener('dragover', (event) => {
      event.preventDefault();
      over(true);
    });
    addEventListener('dragleave', (event) => {
      if (event.relatedTarget === null) over(false);
    });
    addEventListener('drop', (event) => {
      event.preventDefault();
      over(false);
      const file = event.dataTransfer?.files[0];
      // The form of a new job takes files for itself.
      if (file && !(event.target as Element).closest('.dropzone')) void this.startFrom(file);
    });
  }

  private async startFrom(file: File): Promise<void> {
    performance.mark('ccst-dropped');
    this.dropState = { file: file.name };
    this.draw();
    try {
      const job = await startFromDrop(file);
      this.dropState = undefined;
      location.hash = `#/jobs/${idOf(job)}`;
    } catch (error) {
      this.dropState = { error: explainFile(error) };
    }
    this.draw();
  }
}

function skipToContent(event: Event): void {
  event.preventDefault();
  document.getElementById('content')?.focus();
}
