import { html, nothing } from 'lit-html';
import type { Mesh } from '@api/mesh_pb';
import { jobsApi, meshesApi } from '../api/clients';
import { explain, type Explanation } from '../api/explain';
import type { FieldError } from '../job/job_request';
import {
  DEFAULT_VALUES,
  OPTION_GROUPS,
  type OptionField,
  type OptionName,
  type OptionValues,
} from '../job/option_fields';
import { OptionsError, startJob, storeFile } from '../job/start_job';
import { valuesOf } from '../job/values_of_job';
import { countWords, figure, idOf } from '../job/words';
import { explainFile } from '../mesh/explain_file';
import { MESH_EXTENSIONS } from '../mesh/mesh_file_names';
import { Painter, type Page } from '../ui/dom';
import { errorNotice } from '../ui/notices';

/** A new job: a mesh, dropped or stored, and all options. `from` is the id of a job to start from. */
export function newJobPage(box: HTMLElement, from: string): Page {
  const left = new AbortController();
  const painter = new Painter(box, template);
  let values: OptionValues = { ...DEFAULT_VALUES };
  let bits = '';
  let stored: Mesh[] = [];
  let mesh: Mesh | undefined;
  let busy = '';
  let error: Explanation | undefined;
  let fieldErrors: FieldError[] = [];

  async function loadStored(): Promise<void> {
    try {
      const { meshes } = await meshesApi.listMeshes({ pageSize: 200 }, { signal: left.signal });
      stored = meshes;
      if (from) {
        const { job } = await jobsApi.getJob({ name: `jobs/${from}` }, { signal: left.signal });
        if (job) values = valuesOf(job);
        mesh = stored.find((m) => m.name === job?.mesh);
      }
    } catch (cause) {
      if (!left.signal.aborted) error = explain(cause);
    }
    painter.later();
  }

  async function take(file: File): Promise<void> {
    busy = `Reading and sending ${file.name}…`;
    error = undefined;
    painter.now();
    try {
      const name = await storeFile(file, Number(bits) || 0);
      ({ mesh } = await meshesApi.getMesh({ name }, { signal: left.signal }));
      if (values.displayName === '') values.displayName = file.name;
      if (mesh) stored = [mesh, ...stored.filter((m) => m.name !== name)];
    } catch (cause) {
      error = explainFile(cause);
    }
    busy = '';
    painter.now();
  }

  async function start(event: Event): Promise<void> {
    event.preventDefault();
    fieldErrors = [];
    error = undefined;
    if (!mesh) {
      error = {
        ...explainFile(new Error()),
        title: 'No mesh yet',
        advice: 'Drop a file above, or choose a stored mesh.',
        detail: '',
        reason: '',
      };
      painter.now();
      return;
    }
    busy = 'Starting…';
    painter.now();
    try {
      location.hash = `#/jobs/${idOf(await startJob(values, mesh.name))}`;
    } catch (cause) {
      if (cause instanceof OptionsError) fieldErrors = cause.errors;
      else error = explain(cause);
    }
    busy = '';
    painter.now();
    box.querySelector<HTMLElement>('[aria-invalid=true]')?.focus();
  }

  function onDrop(event: DragEvent): void {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) void take(file);
  }

  function set(name: OptionName, value: string | Uint8Array): void {
    values = { ...values, [name]: value };
    fieldErrors = fieldErrors.filter((e) => e.field !== name);
    painter.now();
  }

  function template() {
    return html`<div class="page-head"><h1>New job</h1></div>
      <form class="new-job" novalidate @submit=${start}>
        <section class="card mesh-card" aria-label="Mesh">
          <h2>Mesh</h2>
          <label class="dropzone" @drop=${onDrop}>
            <input
              type="file"
              class="visually-hidden"
              accept=${MESH_EXTENSIONS.join(',')}
              @change=${(event: Event) => {
                const file = (event.target as HTMLInputElement).files?.[0];
                if (file) void take(file);
              }}
            />
            <strong>Drop a mesh here, or choose a file</strong>
            <span class="quiet">OBJ, PLY, STL, OFF, GLB or Draco; encoded here, nothing lost</span>
          </label>
          <label class="field">
            <span>Stored meshes</span>
            <select
              @change=${(event: Event) => {
                const { value } = event.target as HTMLSelectElement;
                mesh = stored.find((m) => m.name === value);
                painter.now();
              }}
            >
              <option value="" ?selected=${!mesh}>${stored.length ? 'Choose one…' : 'None yet'}</option>
              ${stored.map(
                (m) => html`<option value=${m.name} ?selected=${m.name === mesh?.name}>
                  ${m.displayName || idOf(m.name).slice(0, 12)} (${countWords(m.faceCount)} faces)
                </option>`,
              )}
            </select>
          </label>
          <label class="field">
            <span>Quantization bits</span>
            <input
              type="number"
              min="0"
              max="24"
              placeholder="off"
              aria-describedby="bits-help"
              .value=${bits}
              @input=${(event: Event) => (bits = (event.target as HTMLInputElement).value)}
            />
            <small id="bits-help">1 to 24: smaller uploads, moved vertices. For the next file.</small>
          </label>
          ${mesh ? meshFacts(mesh) : nothing}
        </section>
        <div class="options">${OPTION_GROUPS.map(group)}</div>
        <div class="submit">
          ${errorNotice(error)}
          <p role="status">${busy}</p>
          <button class="primary" ?disabled=${busy !== ''}>Start the job</button>
        </div>
      </form>`;
  }

  function meshFacts(m: Mesh) {
    return html`<dl class="facts mesh-facts">
        <div><dt>Vertices</dt><dd>${countWords(m.vertexCount)}</dd></div>
        <div><dt>Faces</dt><dd>${countWords(m.faceCount)}</dd></div>
        <div><dt>Area</dt><dd>${figure(m.surfaceArea)}</dd></div>
        <div><dt>Components</dt><dd>${m.componentCount}</dd></div>
        <div><dt>Boundary loops</dt><dd>${m.boundaryLoopCount}</dd></div>
        ${m.attributes.length
          ? html`<div><dt>Attributes</dt><dd>${m.attributes.map((a) => a.attributeName).join(', ')}</dd></div>`
          : nothing}
      </dl>
      ${m.warnings.map((warning) => html`<p class="notice warn">${warning}</p>`)}`;
  }

  function group({ title, fields }: (typeof OPTION_GROUPS)[number]) {
    const shown = fields.filter((f) => f.when?.(values) ?? true);
    return html`<fieldset class="card">
      <legend>${title}</legend>
      ${shown.map(field)}
    </fieldset>`;
  }

  function field(f: OptionField) {
    const wrong = fieldErrors.find((e) => e.field === f.name);
    const id = `option-${f.name}`;
    const about = html`${f.help ? html`<small id="${id}-help">${f.help}</small>` : nothing}
    ${wrong ? html`<small class="wrong" id="${id}-wrong" role="alert">Give ${wrong.message}.</small>` : nothing}`;
    if (f.kind === 'switch') {
      return html`<label class="switch">
        <input
          id=${id}
          type="checkbox"
          .checked=${values[f.name as Exclude<OptionName, 'image'>] === 'on'}
          @change=${(e: Event) => set(f.name, (e.target as HTMLInputElement).checked ? 'on' : '')}
        />
        ${f.label}
      </label>`;
    }
    return html`<div class="field">
      <label for=${id}>${f.label}</label>
      ${input(f, id, wrong !== undefined)} ${about}
    </div>`;
  }

  function input(f: OptionField, id: string, wrong: boolean) {
    const describedBy = `${id}-help${wrong ? ` ${id}-wrong` : ''}`;
    const invalid = wrong ? 'true' : 'false';
    if (f.kind === 'image') {
      const choose = async (event: Event) => {
        const file = (event.target as HTMLInputElement).files?.[0];
        if (file) set('image', new Uint8Array(await file.arrayBuffer()));
      };
      return html`<input id=${id} type="file" accept="image/png,image/jpeg" aria-invalid=${invalid} @change=${choose} />`;
    }
    const value = values[f.name as Exclude<OptionName, 'image'>];
    if (f.kind === 'choice') {
      return html`<select
        id=${id}
        aria-describedby=${describedBy}
        @change=${(e: Event) => set(f.name, (e.target as HTMLSelectElement).value)}
      >
        ${f.choices?.map(
          ([choice, words]) =>
            html`<option value=${choice} ?selected=${choice === value}>${words}</option>`,
        )}
      </select>`;
    }
    return html`<input
      id=${id}
      type="text"
      inputmode=${f.kind === 'number' ? 'decimal' : 'text'}
      autocomplete="off"
      placeholder=${f.placeholder ?? ''}
      aria-describedby=${describedBy}
      aria-invalid=${invalid}
      .value=${value}
      @input=${(e: Event) => set(f.name, (e.target as HTMLInputElement).value)}
    />`;
  }

  painter.now();
  void loadStored();
  return {
    title: 'New job',
    leave() {
      left.abort();
      painter.stop();
    },
  };
}
