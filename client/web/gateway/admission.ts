import type { DescMethod } from '@bufbuild/protobuf';
import { Code, ConnectError, type Transport } from '@connectrpc/connect';
import { codeToHttpStatus, errorToJson } from '@connectrpc/connect/protocol-connect';
import { ServerInfoService, type ServerLimits } from '@api/server_info_service_pb';
import { heldBytes, mayBeLarge, readLimit, serversLimit, SMALL_BYTES } from './limits';
import type { Request, Response } from './page_files';

const PROBE_TIMEOUT_MS = 5000;
/** A refused body is read and thrown away up to here, so that its sender gets to read why. */
const DISCARDED_BYTES = 64 * 1024 * 1024;
/** A body takes at most as long as this, and the time of a slow line. */
const BODY_GRACE_MS = 60_000;
const SLOW_BYTES_PER_MS = 16;

/** Bounds on what callers may make the gateway hold. */
export interface AdmissionOptions {
  /** Of one message [byte]. */
  maxMessageBytes: number;
  /** Of all requests under way [byte]. */
  maxBytesUnderWay: number;
}

const COMPRESSION_HEADERS = ['content-encoding', 'connect-content-encoding', 'grpc-encoding'];

function header(request: Request, name: string): string {
  return String(request.headers[name] ?? '');
}

function contentLength(request: Request): number | undefined {
  const text = header(request, 'content-length');
  return /^\d+$/.test(text) ? Number(text) : undefined;
}

function connectionOf(request: Request): object {
  return 'stream' in request ? (request.stream.session ?? request.stream) : request.socket;
}

function exhausted(message: string): ConnectError {
  return new ConnectError(message, Code.ResourceExhausted);
}

/**
 * Decides which calls are let through, before any of their body is read: nothing compressed, nothing
 * larger than the server takes of the method, nothing large from callers whom the server does not
 * know, and no more at once than the gateway may hold.
 */
export class Admission {
  private readonly methods = new Map<string, DescMethod>();
  private readonly heldBy = new Map<object, number>();
  private held = 0;

  constructor(
    methods: DescMethod[],
    private readonly transport: Transport,
    private readonly options: AdmissionOptions,
  ) {
    for (const method of methods) this.methods.set(`/${method.parent.typeName}/${method.name}`, method);
  }

  /**
   * Calls `serve` when the call may go on, now or once the server was asked; answers it otherwise.
   * What is no call of the API goes on as it is.
   */
  admit(request: Request, response: Response, serve: () => void): void {
    const method = this.methods.get((request.url ?? '').replace(/[?#].*$/, ''));
    if (method === undefined || request.method !== 'POST') return serve();
    const release = { now: () => {} };
    response.once('close', () => release.now());
    this.check(request, method, release)
      .then(
        () => {
          if (response.destroyed) return;
          this.limitTime(request);
          serve();
        },
        (error: unknown) => this.refuse(request, response, ConnectError.from(error, Code.Unavailable)),
      )
      .catch(() => response.destroy());
  }

  private async check(request: Request, method: DescMethod, release: { now: () => void }): Promise<void> {
    const encoding = COMPRESSION_HEADERS.map((name) => header(request, name)).find(
      (value) => value !== '' && value !== 'identity',
    );
    if (encoding !== undefined) {
      throw new ConnectError(`the gateway takes no compressed requests (${encoding})`, Code.Unimplemented);
    }
    const length = contentLength(request);
    const isStream = method.methodKind === 'client_streaming';
    const most = readLimit(method, this.options.maxMessageBytes);
    if (!isStream && length !== undefined && length > most) {
      throw exhausted(`the request has ${length} bytes; at most ${most} are taken of ${method.name}`);
    }
    release.now = this.hold(connectionOf(request), heldBytes(method, length, this.options.maxMessageBytes));
    if (!mayBeLarge(method) || (length !== undefined && length <= SMALL_BYTES)) return;
    const limits = await this.askServer(header(request, 'authorization'));
    const servers = serversLimit(method, limits, /json/.test(header(request, 'content-type')));
    if (length !== undefined && length > servers) {
      throw exhausted(`the request has ${length} bytes; the server takes at most ${servers} of ${method.name}`);
    }
  }

  /** Takes `bytes` of what all and one connection may hold; what it returns gives them back. */
  private hold(connection: object, bytes: number): () => void {
    const { maxBytesUnderWay, maxMessageBytes } = this.options;
    const own = (this.heldBy.get(connection) ?? 0) + bytes;
    if (own > maxMessageBytes) {
      throw exhausted(`requests of ${own} bytes are under way on this connection, of at most ${maxMessageBytes}`);
    }
    if (this.held + bytes > maxBytesUnderWay) {
      throw exhausted('the gateway has as many bytes under way as it may; try again later');
    }
    this.held += bytes;
    this.heldBy.set(connection, own);
    return () => {
      this.held -= bytes;
      const left = (this.heldBy.get(connection) ?? 0) - bytes;
      if (left > 0) this.heldBy.set(connection, left);
      else this.heldBy.delete(connection);
    };
  }

  /** The server's limits. @throws what the server says to this caller, UNAUTHENTICATED for example */
  private async askServer(authorization: string): Promise<ServerLimits> {
    const headers = authorization === '' ? undefined : { authorization };
    const { message } = await this.transport.unary(
      ServerInfoService.method.getServerInfo,
      undefined,
      PROBE_TIMEOUT_MS,
      headers,
      {},
    );
    if (message.limits === undefined) {
      throw new ConnectError('the server does not say its limits', Code.Unavailable);
    }
    return message.limits;
  }

  /** Ends a call whose body does not come within the time of a slow line. */
  private limitTime(request: Request): void {
    const length = contentLength(request);
    if (length === undefined) return;
    const timer = setTimeout(() => request.destroy(), BODY_GRACE_MS + length / SLOW_BYTES_PER_MS);
    for (const event of ['end', 'close'] as const) request.once(event, () => clearTimeout(timer));
  }

  private refuse(request: Request, response: Response, error: ConnectError): void {
    if (response.destroyed) return;
    const body = JSON.stringify(errorToJson(error, undefined));
    response.writeHead(codeToHttpStatus(error.code), {
      'content-type': 'application/json',
      'content-length': Buffer.byteLength(body),
    });
    // The connection stays open for that: closed, it would take the answer along.
    let discarded = 0;
    request.on('data', (bytes: Buffer) => {
      discarded += bytes.length;
      if (discarded > DISCARDED_BYTES) request.destroy();
    });
    this.limitTime(request);
    response.end(body);
  }
}
