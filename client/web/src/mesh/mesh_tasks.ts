import type { EncodedMesh, MeshAnswer, MeshTask } from './mesh_worker';
import { MeshFileError, type SurfaceMesh } from './surface_mesh';

type Task = MeshTask extends infer T ? (T extends MeshTask ? Omit<T, 'id'> : never) : never;
type Waiting = { resolve(answer: MeshAnswer): void; reject(error: Error): void };

let worker: Worker | undefined;
let lastId = 0;
const waiting = new Map<number, Waiting>();

/** Starts the worker that reads, encodes and decodes meshes; later calls do nothing. */
export function warmMeshWorker(): Worker {
  if (worker) return worker;
  worker = new Worker(new URL('./mesh_worker.ts', import.meta.url), { type: 'module' });
  worker.onmessage = (event: MessageEvent<MeshAnswer>) => {
    waiting.get(event.data.id)?.resolve(event.data);
    waiting.delete(event.data.id);
  };
  worker.onerror = (event) => {
    // Out of memory, most likely. The next task gets a new worker.
    for (const task of waiting.values()) task.reject(new MeshFileError(event.message));
    waiting.clear();
    worker?.terminate();
    worker = undefined;
  };
  return worker;
}

async function perform(task: Task): Promise<MeshAnswer> {
  const id = ++lastId;
  const answer = await new Promise<MeshAnswer>((resolve, reject) => {
    waiting.set(id, { resolve, reject });
    warmMeshWorker().postMessage({ ...task, id });
  });
  if ('error' in answer) throw new MeshFileError(answer.error);
  return answer;
}

/**
 * Reads a mesh file and encodes it to Draco, off the page's thread. `bits` as in `encodeDraco`.
 * @throws MeshFileError
 */
export async function encodeFile(file: File, bits: number): Promise<EncodedMesh> {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const answer = await perform({ kind: 'encode', fileName: file.name, bytes, bits });
  return (answer as { encoded: EncodedMesh }).encoded;
}

/** Decodes a Draco mesh. @throws MeshFileError */
export async function decodeSurface(bytes: Uint8Array): Promise<SurfaceMesh> {
  return ((await perform({ kind: 'decode', bytes })) as { surface: SurfaceMesh }).surface;
}
