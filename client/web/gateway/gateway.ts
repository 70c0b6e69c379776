import * as http from 'node:http';
import * as http2 from 'node:http2';
import type { AddressInfo } from 'node:net';
import type { Transport } from '@connectrpc/connect';
import { connectNodeAdapter, createGrpcTransport } from '@connectrpc/connect-node';
import { MeshService } from '@api/mesh_service_pb';
import { SamplingService } from '@api/sampling_service_pb';
import { ServerInfoService } from '@api/server_info_service_pb';
import { Health, HealthCheckResponse_ServingStatus } from '@health/health_pb';
import { Admission } from './admission';
import { forwardTo } from './forward';
import { hostAllowed, type GatewayOptions } from './options';
import { PageFiles, SECURITY_HEADERS, sendText, type Request, type Response } from './page_files';

// The largest message of a server, which sends at most 4 MiB.
const MAX_ANSWER_BYTES = 8 * 1024 * 1024;
const HEALTH_TIMEOUT_MS = 3000;
// Streams are calls too: each page has one for every job that it follows.
const MAX_CONNECTIONS = 2048;
const MAX_STREAMS_PER_CONNECTION = 128;

async function reportHealth(transport: Transport, response: Response): Promise<void> {
  try {
    const answer = await transport.unary(
      Health.method.check,
      undefined,
      HEALTH_TIMEOUT_MS,
      undefined,
      {},
    );
    const serving = answer.message.status === HealthCheckResponse_ServingStatus.SERVING;
    sendText(response, serving ? 200 : 503, serving ? 'ok' : 'the server is not serving');
  } catch (error) {
    sendText(response, 503, `the server cannot be reached: ${(error as Error).message}`);
  }
}

/** A gateway that listens. */
export interface Gateway {
  /** Where browsers find the page. */
  url: string;
  /** Stops listening and ends what is open. */
  close(): Promise<void>;
}

/**
 * Serves the page of `options.page` and forwards the calls of `ccst.v1` to `options.server`.
 * @throws when the address cannot be had or the page is not there
 */
export async function startGateway(options: GatewayOptions): Promise<Gateway> {
  const transport = createGrpcTransport({
    baseUrl: options.server,
    readMaxBytes: MAX_ANSWER_BYTES,
    acceptCompression: [],
    ...(options.serverCa === undefined ? {} : { nodeOptions: { ca: options.serverCa } }),
  });
  const page = new PageFiles(options.page);
  const methods = [SamplingService, MeshService, ServerInfoService].flatMap((s) => s.methods);
  const serve = connectNodeAdapter({
    routes: forwardTo(transport, methods, options.maxMessageBytes),
    // A few bytes of gzip are hundreds of megabytes when they are read.
    acceptCompression: [],
    fallback: (request, response) => page.serve(request, response),
  });
  const admission = new Admission(methods, transport, options);

  function handle(request: Request, response: Response): void {
    for (const [name, value] of Object.entries(SECURITY_HEADERS)) response.setHeader(name, value);
    const host = String(request.headers[':authority'] ?? request.headers.host ?? '');
    const origin = request.headers.origin;
    if (!hostAllowed(host, options)) {
      sendText(response, 421, `the gateway does not answer to ${host}; --allow-host makes it`);
    } else if (origin !== undefined && origin.replace(/^https?:\/\//, '') !== host) {
      sendText(response, 403, 'other sites may not call the gateway');
    } else if (request.url === '/healthz') {
      void reportHealth(transport, response);
    } else {
      admission.admit(request, response, () => serve(request, response));
    }
  }

  const server = options.tls
    ? http2.createSecureServer(
        {
          ...options.tls,
          allowHTTP1: true,
          settings: { maxConcurrentStreams: MAX_STREAMS_PER_CONNECTION },
        },
        handle,
      )
    : http.createServer(handle);
  server.maxConnections = MAX_CONNECTIONS;
  const sessions = new Set<http2.ServerHttp2Session>();
  server.on('session', (session: http2.ServerHttp2Session) => {
    sessions.add(session);
    session.on('close', () => sessions.delete(session));
  });
  await new Promise<void>((resolve, reject) => {
    server.once('error', reject);
    server.listen(options.port, options.host, resolve);
  });
  const { port } = server.address() as AddressInfo;
  const host = options.host.includes(':') ? `[${options.host}]` : options.host;
  return {
    url: `${options.tls ? 'https' : 'http'}://${host}:${port}`,
    close: () =>
      new Promise((resolve) => {
        server.close(() => resolve());
        if (server instanceof http.Server) server.closeAllConnections();
        for (const session of sessions) session.destroy();
      }),
  };
}
