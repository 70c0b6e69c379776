import { Job_State, type Job } from '@api/job_pb';
import type { SamplePreview, WatchJobResponse } from '@api/sampling_service_pb';
import { explain, type Explanation } from '../api/explain';
import { RunHistory } from './run_history';

/** How the page is connected to a job. */
export type Connection =
  | { state: 'connecting' | 'live' | 'ended' }
  | { state: 'reconnecting'; why: Explanation }
  | { state: 'failed'; why: Explanation };

export interface WatchListener {
  onJob(job: Job): void;
  /** The history has grown. */
  onProgress(history: RunHistory): void;
  onPreview(preview: SamplePreview): void;
  onConnection(connection: Connection): void;
}

/** What a watch needs of the outside; tests bring their own. */
export interface WatchPorts {
  open(afterSequence: bigint, signal: AbortSignal): AsyncIterable<WatchJobResponse>;
  /** Resolves after a time, or as soon as the signal fires. */
  wait(milliseconds: number, signal: AbortSignal): Promise<void>;
  /** In [0, 1). */
  random(): number;
}

const FIRST_DELAY_MS = 250;
const LONGEST_DELAY_MS = 5000;
// The server says something every 10 s at least.
const SILENCE_MS = 25_000;

export function hasEnded(state: Job_State): boolean {
  return [Job_State.SUCCEEDED, Job_State.FAILED, Job_State.CANCELLED].includes(state);
}

/**
 * Follows one job until it ends: opens the stream again when it breaks, after the last sequence seen,
 * waiting longer each time in vain. Gives up on errors that waiting does not mend.
 */
export class JobWatch {
  readonly history = new RunHistory();
  private readonly stopped = new AbortController();
  private ended = false;

  constructor(
    private readonly ports: WatchPorts,
    private readonly listener: WatchListener,
  ) {}

  /** Returns when the job has ended, the watch was stopped, or nothing can be mended. */
  async run(): Promise<void> {
    const stop = this.stopped.signal;
    this.listener.onConnection({ state: 'connecting' });
    for (let attempt = 0; !stop.aborted; ++attempt) {
      let why: Explanation;
      try {
        await this.readOnce(() => (attempt = 0));
        if (this.ended) {
          this.listener.onConnection({ state: 'ended' });
          return;
        }
        why = explain(new Error('the stream closed before the job had ended'));
      } catch (error) {
        why = explain(error);
      }
      if (stop.aborted) return;
      if (!why.transient && why.reason !== 'Canceled') {
        this.listener.onConnection({ state: 'failed', why });
        return;
      }
      this.listener.onConnection({ state: 'reconnecting', why });
      const delay = Math.min(LONGEST_DELAY_MS, FIRST_DELAY_MS * 2 ** attempt);
      // Jitter: not all pages come back at the same moment.
      const jittered = delay * (0.5 + this.ports.random() / 2);
      await this.ports.wait(Math.max(jittered, why.retryAfterMs), stop);
    }
  }

  stop(): void {
    this.stopped.abort();
  }

  private async readOnce(onMessage: () => void): Promise<void> {
    const call = new AbortController();
    const abort = () => call.abort();
    this.stopped.signal.addEventListener('abort', abort);
    let silence = setTimeout(abort, SILENCE_MS);
    let live = false;
    try {
      for await (const message of this.ports.open(this.history.lastSequence, call.signal)) {
        clearTimeout(silence);
        silence = setTimeout(abort, SILENCE_MS);
        onMessage();
        if (!live) this.listener.onConnection({ state: 'live' });
        live = true;
        this.take(message);
      }
    } finally {
      clearTimeout(silence);
      this.stopped.signal.removeEventListener('abort', abort);
    }
  }

  private take({ sequence, event }: WatchJobResponse): void {
    switch (event.case) {
      case 'snapshot':
        this.ended = hasEnded(event.value.state);
        this.listener.onJob(event.value);
        break;
      case 'progress':
        if (this.history.add(sequence, event.value)) this.listener.onProgress(this.history);
        break;
      case 'preview':
        this.listener.onPreview(event.value);
        break;
      default: // Heartbeats, and events that a newer server may send.
    }
  }
}
