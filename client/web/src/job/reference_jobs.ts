import { create } from '@bufbuild/protobuf';
import { Job_State, SamplingMethod, SamplingOptionsSchema, type Job } from '@api/job_pb';
import type { AnalyzeJobResponse } from '@api/sampling_service_pb';
import { jobsApi } from '../api/clients';
import { referenceOptions } from './reference_options';
import { idOf } from './words';

/** What results are held against: what the field does today, and no method at all. */
export const REFERENCE_METHODS: { method: SamplingMethod; title: string }[] = [
  { method: SamplingMethod.POISSON_DISK, title: 'Poisson disk' },
  { method: SamplingMethod.WHITE_NOISE, title: 'White noise' },
];

// Marks a job as made to compare with another one, so that a page opened again finds it.
const LABEL = 'reference-of';
// A job that failed or was cancelled, or is about to be, leaves no samples to compare with.
const USABLE_STATES = [Job_State.QUEUED, Job_State.RUNNING, Job_State.SUCCEEDED];

/** Whether reference jobs can be had: an image is not kept with the options. */
export function canHaveReferences(job: Job): boolean {
  return job.effectiveOptions?.density.case !== 'texture';
}

/**
 * The reference jobs that were started for `job` and have or will have samples, the latest of each
 * method.
 */
export async function findReferences(job: Job, signal: AbortSignal): Promise<Map<SamplingMethod, Job>> {
  const { jobs } = await jobsApi.listJobs(
    { labels: { [LABEL]: idOf(job.name) }, states: USABLE_STATES },
    { signal },
  );
  const found = new Map<SamplingMethod, Job>();
  // Newest first.
  for (const other of jobs.reverse()) found.set(other.effectiveOptions?.method ?? 0, other);
  return found;
}

/**
 * The reference job of `method` for `job`: the latest that has or will have samples, else a new one. Safe
 * to repeat: a job whose answer was lost on the way is found by its label. Its request id is new each
 * time, because the server answers a known one with the job it made, also when that job has failed.
 */
export async function ensureReference(
  job: Job,
  method: SamplingMethod,
  title: string,
  signal: AbortSignal,
): Promise<Job> {
  const existing = (await findReferences(job, signal)).get(method);
  if (existing) return existing;
  const options = job.effectiveOptions ?? create(SamplingOptionsSchema);
  const answer = await jobsApi.createJob(
    {
      spec: { mesh: job.mesh, options: referenceOptions(options, method) },
      requestId: crypto.randomUUID(),
      displayName: `${title} beside ${idOf(job.name).slice(0, 8)}`,
      labels: { [LABEL]: idOf(job.name) },
    },
    { signal },
  );
  if (!answer.job) throw new Error('the server sent no job');
  return answer.job;
}

/** The quality of a job's samples, once it has ended; the server says so where it left none. */
export async function analyzeWhenEnded(job: Job, signal: AbortSignal): Promise<AnalyzeJobResponse> {
  // The stream ends with the job; what it tells before is not shown.
  for await (const { event: _ } of jobsApi.watchJob({ name: job.name, afterSequence: 2n ** 62n }, { signal }));
  return jobsApi.analyzeJob({ name: job.name }, { signal });
}
