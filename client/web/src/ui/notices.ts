import { html, nothing, type TemplateResult } from 'lit-html';
import type { Explanation } from '../api/explain';

/** An error in words, with what to do. */
export function errorNotice(error: Explanation | undefined): TemplateResult | typeof nothing {
  if (!error) return nothing;
  return html`<div class="notice bad" role="alert">
    <strong>${error.title}</strong>
    <p>${error.advice}</p>
    <p class="detail">${error.detail} <code>${error.reason}</code></p>
    ${error.violations.length === 0
      ? nothing
      : html`<ul>
          ${error.violations.map((v) => html`<li><code>${v.field}</code> ${v.description}</li>`)}
        </ul>`}
  </div>`;
}

/** What stands where there is nothing to show. */
export function emptyState(title: string, more: unknown): TemplateResult {
  return html`<div class="empty">
    <h2>${title}</h2>
    <p>${more}</p>
  </div>`;
}

/** What stands where something is on its way. */
export function loadingState(what: string): TemplateResult {
  return html`<p class="loading" role="status">${what}…</p>`;
}
