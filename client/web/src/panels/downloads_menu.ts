import { html } from 'lit-html';
import type { Job } from '@api/job_pb';
import { readSampleMesh, readSamples } from '../job/read_results';
import { idOf } from '../job/words';
import { writeCsv, writeObj, type Writable } from '../export/write_mesh';
import { writePly } from '../export/write_ply';

type Writer = (content: Writable) => Blob | Promise<Blob>;

// Loaded when it is needed: most pages never write glTF.
const writeGlb: Writer = async (content) => (await import('../export/write_glb')).writeGlb(content);

const FORMATS: Record<string, Writer> = { ply: writePly, obj: writeObj, glb: writeGlb, csv: writeCsv };

async function download(job: Job, what: 'samples' | 'mesh', format: string): Promise<void> {
  const { signal } = new AbortController();
  const { result, origin } = job;
  const count = Number(result?.sampleCount ?? 0n);
  const content: Writable = {
    samples: await readSamples(job.name, count, signal),
    origin: [origin?.x ?? 0, origin?.y ?? 0, origin?.z ?? 0],
  };
  if (what === 'mesh') {
    const faces = Number(result?.sampleMeshFaceCount ?? 0n);
    content.triangles = await readSampleMesh(job.name, faces, signal);
  }
  const blob = await FORMATS[format]?.(content);
  if (!blob) return;
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = `${what}-${idOf(job.name).slice(0, 8)}.${format}`;
  link.click();
  URL.revokeObjectURL(link.href);
}

/** A menu of what can be taken home. `act` shows what goes wrong. */
export function downloadsMenu(job: Job, act: (call: () => Promise<unknown>) => Promise<boolean>) {
  const item = (what: 'samples' | 'mesh', format: string) =>
    html`<button
      @click=${(event: Event) => {
        (event.target as Element).closest('details')?.removeAttribute('open');
        void act(() => download(job, what, format));
      }}
    >
      ${what === 'mesh' ? 'Mesh' : 'Samples'} .${format}
    </button>`;
  const hasMesh = (job.result?.sampleMeshFaceCount ?? 0n) > 0n;
  return html`<details class="menu">
    <summary class="button">Download</summary>
    <div class="menu-items">
      ${['ply', 'obj', 'glb', 'csv'].map((format) => item('samples', format))}
      ${hasMesh ? ['ply', 'obj', 'glb'].map((format) => item('mesh', format)) : ''}
    </div>
  </details>`;
}
