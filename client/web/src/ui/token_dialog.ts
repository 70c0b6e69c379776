import { html, render } from 'lit-html';
import { currentToken, setToken } from '../api/token';

/** Asks for the server's token; `changed` is called after it was set or forgotten. */
export function openTokenDialog(changed: () => void): void {
  const dialog = document.createElement('dialog');
  dialog.setAttribute('aria-labelledby', 'token-title');
  const finish = (token: string) => {
    setToken(token.trim());
    dialog.close();
    changed();
  };
  const onSubmit = (event: Event) => {
    event.preventDefault();
    finish(String(new FormData(event.target as HTMLFormElement).get('token') ?? ''));
  };
  render(
    html`<form class="token-form" @submit=${onSubmit}>
      <h2 id="token-title">Token</h2>
      <p>
        Servers that ask for a token know you by it. It is kept for this tab and forgotten when the tab
        closes.
      </p>
      <label class="field">
        <span>Token</span>
        <input
          name="token"
          type="password"
          autocomplete="off"
          placeholder="ccst_…"
          .value=${currentToken() ?? ''}
        />
      </label>
      <div class="actions">
        <button type="button" @click=${() => finish('')}>Forget it</button>
        <button type="button" @click=${() => dialog.close()}>Close</button>
        <button class="primary">Use it</button>
      </div>
    </form>`,
    dialog,
  );
  dialog.addEventListener('close', () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
