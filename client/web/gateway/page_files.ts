import { readdirSync, readFileSync } from 'node:fs';
import { extname, join, relative, sep } from 'node:path';
import { gzipSync } from 'node:zlib';
import type { connectNodeAdapter } from '@connectrpc/connect-node';

type Handler = ReturnType<typeof connectNodeAdapter>;
/** A request or response of HTTP/1.1 or HTTP/2. */
export type Request = Parameters<Handler>[0];
export type Response = Parameters<Handler>[1];


const TYPES: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
};

/** Sent with every answer. Workers and WebAssembly are the page's own; nothing else may run. */
export const SECURITY_HEADERS: Record<string, string> = {
  'content-security-policy': [
    "default-src 'none'",
    "script-src 'self' 'wasm-unsafe-eval'",
    "worker-src 'self'",
    "connect-src 'self'",
    "style-src 'self'",
    "img-src 'self' blob: data:",
    "base-uri 'none'",
    "form-action 'none'",
    "frame-ancestors 'none'",
  ].join('; '),
  'cross-origin-opener-policy': 'same-origin',
  'cross-origin-resource-policy': 'same-origin',
  'referrer-policy': 'no-referrer',
  'x-content-type-options': 'nosniff',
};

interface PageFile {
  type: string;
  plain: Buffer;
  gzipped: Buffer;
  /** Its name changes with its content. */
  lasting: boolean;
}

/** The built page, held in memory: it is small, and nothing else of the disk can be asked for. */
export class PageFiles {
  private readonly files = new Map<string, PageFile>();

  /** @throws when `folder` has no index.html */
  constructor(folder: string) {
    for (const entry of readdirSync(folder, { withFileTypes: true, recursive: true })) {
      if (!entry.isFile()) continue;
      const path = join(entry.parentPath ?? entry.path, entry.name);
      const plain = readFileSync(path);
      const name = '/' + relative(folder, path).split(sep).join('/');
      this.files.set(name, {
        type: TYPES[extname(name)] ?? 'application/octet-stream',
        plain,
        gzipped: gzipSync(plain),
        lasting: name.startsWith('/assets/'),
      });
    }
    const index = this.files.get('/index.html');
    if (!index) throw new Error(`${folder} has no index.html: build the page first`);
    this.files.set('/', index);
  }

  /** Answers a GET or HEAD; 404 for what is not a part of the page. */
  serve(request: Request, response: Response): void {
    const path = (request.url ?? '/').replace(/[?#].*$/, '');
    const file = this.files.get(path);
    if (request.method !== 'GET' && request.method !== 'HEAD') {
      sendText(response, 405, 'only GET and HEAD');
    } else if (!file) {
      sendText(response, 404, 'not a part of the page');
    } else {
      const gzip = /\bgzip\b/.test(String(request.headers['accept-encoding'] ?? ''));
      const body = gzip ? file.gzipped : file.plain;
      response.writeHead(200, {
        'content-type': file.type,
        'content-length': body.length,
        'cache-control': file.lasting ? 'public, max-age=31536000, immutable' : 'no-cache',
        vary: 'accept-encoding',
        ...(gzip ? { 'content-encoding': 'gzip' } : {}),
      });
      response.end(request.method === 'HEAD' ? '' : body);
    }
  }
}

export function sendText(response: Response, status: number, text: string): void {
  response.writeHead(status, { 'content-type': 'text/plain; charset=utf-8' });
  response.end(text + '\n');
}
