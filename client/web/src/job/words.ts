import {
  Job_State,
  JobPhase,
  SamplingMethod,
  TerminationReason,
  type Job,
  type SamplingOptions,
} from '@api/job_pb';
import type { Timestamp } from '@bufbuild/protobuf/wkt';

export const STATE_WORDS: Record<Job_State, string> = {
  [Job_State.UNSPECIFIED]: 'unknown',
  [Job_State.QUEUED]: 'queued',
  [Job_State.RUNNING]: 'running',
  [Job_State.CANCELLING]: 'cancelling',
  [Job_State.SUCCEEDED]: 'succeeded',
  [Job_State.FAILED]: 'failed',
  [Job_State.CANCELLED]: 'cancelled',
};

export const PHASE_WORDS: Record<JobPhase, string> = {
  [JobPhase.UNSPECIFIED]: 'waiting',
  [JobPhase.PREPARING]: 'preparing the surface',
  [JobPhase.INITIALIZING]: 'placing the first samples',
  [JobPhase.RELAXING]: 'relaxing',
  [JobPhase.FINALIZING]: 'finishing',
};

export const METHOD_WORDS: Record<SamplingMethod, string> = {
  [SamplingMethod.UNSPECIFIED]: 'CCST',
  [SamplingMethod.CCST]: 'CCST',
  [SamplingMethod.WHITE_NOISE]: 'white noise',
  [SamplingMethod.POISSON_DISK]: 'Poisson disk',
  [SamplingMethod.LLOYD]: 'Lloyd',
  [SamplingMethod.CCVT]: 'CCVT',
  [SamplingMethod.SAMPLE_ELIMINATION]: 'sample elimination',
};

export const TERMINATION_WORDS: Record<TerminationReason, string> = {
  [TerminationReason.UNSPECIFIED]: '',
  [TerminationReason.CONVERGED]: 'converged',
  [TerminationReason.ITERATION_LIMIT]: 'stopped at its alternation limit',
  [TerminationReason.TIME_LIMIT]: 'stopped at its time limit',
  [TerminationReason.CANCELLED]: 'cancelled',
};

/** The part of `jobs/{uuid}` or `meshes/{sha256}` after the slash. */
export function idOf(name: string): string {
  return name.slice(name.indexOf('/') + 1);
}

/** What a list calls a job: its name for people, else the start of its id. */
export function titleOf(job: Job): string {
  return job.displayName || `job ${idOf(job.name).slice(0, 8)}`;
}

export function densityWords(options: SamplingOptions | undefined): string {
  switch (options?.density.case) {
    case 'attribute':
      return `attribute ${options.density.value.attributeName}`;
    case 'curvature':
      return 'curvature';
    case 'texture':
      return 'image';
    default:
      return 'uniform';
  }
}

export function countWords(count: bigint | number): string {
  return Number(count).toLocaleString('en');
}

/** Three digits or so: what a table or an axis has room for. */
export function figure(value: number | undefined): string {
  if (value === undefined || Number.isNaN(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2);
  return String(Number(value.toPrecision(size >= 100 ? 4 : 3)));
}

/** 0.26 s, 12 s, 3 min 20 s. */
export function durationWords(seconds: number): string {
  if (seconds < 0.01) return `${(seconds * 1000).toFixed(1)} ms`;
  if (seconds < 10) return `${seconds.toFixed(2)} s`;
  if (seconds < 60) return `${Math.round(seconds)} s`;
  const minutes = Math.floor(seconds / 60);
  return `${minutes} min ${Math.round(seconds - 60 * minutes)} s`;
}

/** How long ago, from `now` in milliseconds. */
export function ageWords(time: Timestamp | undefined, now: number): string {
  if (!time) return '';
  const seconds = Math.max(0, now / 1000 - Number(time.seconds));
  if (seconds < 10) return 'just now';
  if (seconds < 60) return `${Math.round(seconds)} s ago`;
  if (seconds < 3600) return `${Math.round(seconds / 60)} min ago`;
  if (seconds < 86400) return `${Math.round(seconds / 3600)} h ago`;
  return `${Math.round(seconds / 86400)} d ago`;
}

/** How much of a run is over, in [0, 1]: 1 when it has ended. */
export function progressShare(job: Job): number {
  if (job.state === Job_State.SUCCEEDED) return 1;
  const progress = job.progress;
  if (!progress || progress.iterationLimit <= 0) return 0;
  return Math.min(1, progress.iteration / progress.iterationLimit);
}
