import { MeshFormat } from '@api/mesh_pb';
import { meshesApi, jobsApi } from '../api/clients';
import { encodeFile } from '../mesh/mesh_tasks';
import { jobRequest, type FieldError } from './job_request';
import { DEFAULT_VALUES, type OptionValues } from './option_fields';

/** Encodes a file and stores it; returns `meshes/{sha256}`. Sends nothing the server has. */
export async function storeFile(file: File, bits = 0): Promise<string> {
  const { data, sha256 } = await encodeFile(file, bits);
  const digest = { sha256, sizeBytes: BigInt(data.length) };
  const { missingDigests } = await meshesApi.findMissingMeshes({ digests: [digest] });
  if (missingDigests.length === 0) return `meshes/${sha256}`;
  const answer = await meshesApi.createMesh({
    header: { digest, format: MeshFormat.DRACO, displayName: file.name.slice(0, 128) },
    data,
  });
  return answer.mesh?.name ?? `meshes/${sha256}`;
}

/** The form has fields that cannot be sent. */
export class OptionsError extends Error {
  constructor(readonly errors: FieldError[]) {
    super(errors.map((e) => `${e.field}: ${e.message}`).join('; '));
  }
}

/** Starts a job and returns its name. @throws OptionsError, ConnectError */
export async function startJob(values: OptionValues, mesh: string): Promise<string> {
  const built = jobRequest(values, mesh, crypto.randomUUID());
  if ('errors' in built) throw new OptionsError(built.errors);
  const { job } = await jobsApi.createJob(built.request);
  return job?.name ?? '';
}

/** A file dropped anywhere: a job with the usual options, named like the file. */
export async function startFromDrop(file: File): Promise<string> {
  const mesh = await storeFile(file);
  return startJob({ ...DEFAULT_VALUES, displayName: file.name.slice(0, 128) }, mesh);
}
