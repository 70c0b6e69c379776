const KEY = 'ccst-token';

/** The caller's token; kept for this tab alone and forgotten when it closes. */
export function currentToken(): string | null {
  return sessionStorage.getItem(KEY);
}

/** An empty text forgets the token. */
export function setToken(token: string): void {
  if (token === '') sessionStorage.removeItem(KEY);
  else sessionStorage.setItem(KEY, token);
}
