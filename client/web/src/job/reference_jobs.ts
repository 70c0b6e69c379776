import { create } from '@bufbuild/protobuf';
import {
  Job_State,
  SamplingMethod,
  SamplingOptionsSchema,
  type Job,
  type SamplingOptions,
} from '@api/job_pb';
import type { AnalyzeJobResponse } from '@api/sampling_service_pb';
import { jobsApi } from '../api/clients';
import { idOf } from './words';

/** What results are held against: what the field does today, and no method at all. */
export const REFERENCE_METHODS: { method: SamplingMethod; title: string }[] = [
  { method: SamplingMethod.POISSON_DISK, title: 'Poisson disk' },
  { method: SamplingMethod.WHITE_NOISE, title: 'White noise' },
];

// Marks a job as made to compare with another one, so that a page opened again finds it.
const LABEL = 'reference-of';

/** The options of a reference job: the same samples' number, seed and density, another method. */
export function referenceOptions(options: SamplingOptions, method: SamplingMethod): SamplingOptions {
  return create(SamplingOptionsSchema, {
    sampleCount: options.sampleCount,
    seed: options.seed ?? 0n,
    density: options.density,
    weldTolerance: options.weldTolerance,
    method,
  });
}

/** Whether reference jobs can be had: an image is not kept with the options. */
export function canHaveReferences(job: Job): boolean {
  return job.effectiveOptions?.density.case !== 'texture';
}

/** The reference jobs that were started for `job`, the latest of each method. */
export async function findReferences(job: Job, signal: AbortSignal): Promise<Map<SamplingMethod, Job>> {
  const { jobs } = await jobsApi.listJobs({ labels: { [LABEL]: idOf(job.name) } }, { signal });
  const found = new Map<SamplingMethod, Job>();
  // Newest first.
  for (const other of jobs.reverse()) found.set(other.effectiveOptions?.method ?? 0, other);
  return found;
}

/** Starts a reference job for `job`; safe to repeat. */
export async function startReference(job: Job, method: SamplingMethod, title: string): Promise<Job> {
  const options = job.effectiveOptions ?? create(SamplingOptionsSchema);
  const answer = await jobsApi.createJob({
    spec: { mesh: job.mesh, options: referenceOptions(options, method) },
    requestId: `reference-${method}-${idOf(job.name)}`,
    displayName: `${title} beside ${idOf(job.name).slice(0, 8)}`,
    labels: { [LABEL]: idOf(job.name) },
  });
  if (!answer.job) throw new Error('the server sent no job');
  return answer.job;
}

/** The quality of a job's samples, once it has ended. */
export async function analyzeWhenEnded(job: Job, signal: AbortSignal): Promise<AnalyzeJobResponse> {
  let state = job.state;
  for await (const { event } of jobsApi.watchJob({ name: job.name, afterSequence: 2n ** 62n }, { signal })) {
    if (event.case === 'snapshot') state = event.value.state;
  }
  if (state !== Job_State.SUCCEEDED) throw new Error('the reference job left no samples');
  return jobsApi.analyzeJob({ name: job.name }, { signal });
}
