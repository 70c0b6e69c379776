import { decodeDraco, encodeDraco } from './draco';
import { decoderModule, encoderModule } from './draco_modules';
import { extensionOf } from './mesh_file_names';
import { readMesh } from './read_mesh';
import type { SurfaceMesh } from './surface_mesh';

/** What the page asks of the worker; answers carry the same number. */
export type MeshTask =
  | { id: number; kind: 'encode'; fileName: string; bytes: Uint8Array; bits: number }
  | { id: number; kind: 'decode'; bytes: Uint8Array };

/** A mesh as it is sent, with what its name is made of. */
export interface EncodedMesh {
  data: Uint8Array;
  sha256: string;
}

export type MeshAnswer =
  | { id: number; encoded: EncodedMesh }
  | { id: number; surface: SurfaceMesh }
  | { id: number; error: string };

async function hex(data: Uint8Array): Promise<string> {
  const digest = await crypto.subtle.digest('SHA-256', data as Uint8Array<ArrayBuffer>);
  return [...new Uint8Array(digest)].map((b) => b.toString(16).padStart(2, '0')).join('');
}

async function encode(fileName: string, bytes: Uint8Array, bits: number): Promise<EncodedMesh> {
  const data =
    extensionOf(fileName) === '.drc'
      ? bytes
      : encodeDraco(await encoderModule(), await readMesh(fileName, bytes), bits);
  return { data, sha256: await hex(data) };
}

async function answer(task: MeshTask): Promise<MeshAnswer> {
  try {
    return task.kind === 'encode'
      ? { id: task.id, encoded: await encode(task.fileName, task.bytes, task.bits) }
      : { id: task.id, surface: decodeDraco(await decoderModule(), task.bytes) };
  } catch (error) {
    return { id: task.id, error: (error as Error).message };
  }
}

self.onmessage = (event: MessageEvent<MeshTask>) => {
  void answer(event.data).then((result) => self.postMessage(result));
};

// Compiled while the user looks for a file: the first drop need not wait for it.
void encoderModule();
