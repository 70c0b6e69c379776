import type { AttributeKind } from '@api/sampling_service_pb';
import { jobsApi, meshesApi } from '../api/clients';

/** An attribute of the mesh at every sample. */
export interface SampleAttribute {
  name: string;
  kind: AttributeKind;
  size: number;
  /** N x size, row major. */
  values: Float32Array;
}

/** All samples of a job. Arrays are row major and N long in their first dimension. */
export interface Samples {
  count: number;
  /** N x 3, relative to the mesh's origin. */
  positions: Float32Array;
  /** N x 3. */
  normals: Float32Array;
  faces: Int32Array;
  /** N x 2. */
  barycentrics: Float64Array;
  attributes: SampleAttribute[];
}

/** Reads all samples of an ended job. `onShare` hears how much is there, in (0, 1]. */
export async function readSamples(
  job: string,
  count: number,
  signal: AbortSignal,
  onShare: (share: number) => void = () => {},
): Promise<Samples> {
  const samples: Samples = {
    count,
    positions: new Float32Array(3 * count),
    normals: new Float32Array(3 * count),
    faces: new Int32Array(count),
    barycentrics: new Float64Array(2 * count),
    attributes: [],
  };
  for await (const { samples: chunk } of jobsApi.readSamples({ name: job }, { signal })) {
    if (!chunk) continue;
    const start = Number(chunk.startIndex);
    samples.positions.set(chunk.positions, 3 * start);
    samples.normals.set(chunk.normals, 3 * start);
    samples.faces.set(chunk.faceIndices, start);
    samples.barycentrics.set(chunk.barycentrics, 2 * start);
    chunk.attributes.forEach(({ name, kind, componentCount: size, values }, k) => {
      const attribute = (samples.attributes[k] ??= {
        name,
        kind,
        size,
        values: new Float32Array(size * count),
      });
      attribute.values.set(values, size * start);
    });
    onShare((start + chunk.faceIndices.length) / count);
  }
  return samples;
}

/** Reads the triangles over the samples, M x 3; empty for methods that make none. */
export async function readSampleMesh(
  job: string,
  faceCount: number,
  signal: AbortSignal,
): Promise<Uint32Array> {
  const indices = new Uint32Array(3 * faceCount);
  if (faceCount === 0) return indices;
  for await (const { sampleMesh } of jobsApi.readSampleMesh({ name: job }, { signal })) {
    if (sampleMesh) indices.set(sampleMesh.vertexIndices, 3 * Number(sampleMesh.startIndex));
  }
  return indices;
}

/** Reads the Draco bytes of a stored mesh. */
export async function readMeshBytes(mesh: string, signal: AbortSignal): Promise<Uint8Array> {
  const chunks: Uint8Array[] = [];
  for await (const { chunk } of meshesApi.downloadMesh({ name: mesh }, { signal })) {
    if (chunk) chunks.push(chunk.data);
  }
  const bytes = new Uint8Array(chunks.reduce((sum, chunk) => sum + chunk.length, 0));
  let offset = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, offset);
    offset += chunk.length;
  }
  return bytes;
}
