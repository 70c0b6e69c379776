import { readFileSync } from 'node:fs';
import { isIP } from 'node:net';
import { parseArgs } from 'node:util';

/** What the gateway was asked to do. */
export interface GatewayOptions {
  host: string;
  /** 0 picks a free one. */
  port: number;
  /** Base address of the gRPC server, http: or https:. */
  server: string;
  /** Who vouches for the server (PEM); undefined trusts the system's authorities. */
  serverCa: string | undefined;
  /** Certificate and key (PEM) to serve the page with; undefined serves plain HTTP. */
  tls: { cert: string; key: string } | undefined;
  /** Folder of the built page. */
  page: string;
  /** Names by which browsers may call the gateway, besides the address it listens on. */
  allowedHosts: string[];
  /** Of one message of a caller [byte]. */
  maxMessageBytes: number;
  /** Of all requests that are under way [byte]; each takes a few times as much memory. */
  maxBytesUnderWay: number;
}

const MIB = 1024 * 1024;
/** Two of the largest requests at a time. */
const MESSAGES_UNDER_WAY = 2;
const MAX_MESSAGE_MIB = 1024;

export const usage = `Serves the dashboard of ccst and forwards its calls to a ccst-server.
Usage: ccst-gateway [OPTIONS]

  --listen HOST:PORT     where browsers connect (127.0.0.1:8080); port 0 picks a free one
  --server HOST:PORT     the gRPC server; else $CCST_SERVER, else 127.0.0.1:50051
  --server-tls           reach the server with TLS
  --server-tls-ca FILE   the same; who vouches for it (PEM)
  --tls-cert FILE        serve HTTPS with this certificate chain (PEM)
  --tls-key FILE         private key of --tls-cert (PEM)
  --insecure             let other machines connect without HTTPS, and reach the server without TLS
  --allow-host NAME      a name by which browsers call the gateway; may be given again
  --max-message-mib N    the largest message of a caller (82), in [1, 1024]; the server has its own
                         limits, max_inline_mesh_bytes for example, and takes no more
  --page FOLDER          the built page (beside the program)
  -h, --help             print this
`;

/** A command line that cannot be followed; the message says what would be right. */
export class UsageError extends Error {}

export function isLoopback(host: string): boolean {
  return host === 'localhost' || host === '::1' || /^127\.\d+\.\d+\.\d+$/.test(host);
}

function splitAddress(flag: string, text: string): { host: string; port: number } {
  const match = /^(?:\[([^\]]+)\]|([^:]+)):(\d+)$/.exec(text);
  const port = Number(match?.[3]);
  if (!match || port > 65535) {
    throw new UsageError(`${flag} ${text}: give HOST:PORT, for example 127.0.0.1:8080`);
  }
  return { host: match[1] ?? match[2] ?? '', port };
}

function readPem(flag: string, file: string): string {
  try {
    return readFileSync(file, 'utf8');
  } catch (error) {
    throw new UsageError(`${flag} ${file}: ${(error as Error).message}`);
  }
}

/**
 * Reads the command line (without program names).
 * @throws UsageError
 */
export function parseOptions(args: string[], environment: NodeJS.ProcessEnv): GatewayOptions | 'help' {
  let values;
  try {
    ({ values } = parseArgs({
      args,
      options: {
        listen: { type: 'string', default: '127.0.0.1:8080' },
        server: { type: 'string' },
        'server-tls': { type: 'boolean', default: false },
        'server-tls-ca': { type: 'string' },
        'tls-cert': { type: 'string' },
        'tls-key': { type: 'string' },
        insecure: { type: 'boolean', default: false },
        'allow-host': { type: 'string', multiple: true, default: [] },
        'max-message-mib': { type: 'string', default: '82' },
        page: { type: 'string' },
        help: { type: 'boolean', short: 'h', default: false },
      },
    }));
  } catch (error) {
    throw new UsageError((error as Error).message);
  }
  if (values.help) return 'help';

  const { host, port } = splitAddress('--listen', values.listen);
  const cert = values['tls-cert'];
  const key = values['tls-key'];
  if ((cert === undefined) !== (key === undefined)) {
    throw new UsageError('--tls-cert and --tls-key belong together: give both or none');
  }
  if (!isLoopback(host) && cert === undefined && !values.insecure) {
    throw new UsageError(
      `--listen ${host} opens the page to other machines: give --tls-cert and --tls-key, or --insecure`,
    );
  }
  const ca = values['server-tls-ca'];
  const scheme = values['server-tls'] || ca !== undefined ? 'https' : 'http';
  const server = values.server ?? environment['CCST_SERVER'] ?? '127.0.0.1:50051';
  if (scheme === 'http' && !isLoopback(splitAddress('--server', server).host) && !values.insecure) {
    throw new UsageError(
      `--server ${server} is another machine, to which tokens would go unencrypted: give --server-tls, --server-tls-ca or --insecure`,
    );
  }
  const mebibytes = Number(values['max-message-mib']);
  if (!Number.isInteger(mebibytes) || mebibytes < 1 || mebibytes > MAX_MESSAGE_MIB) {
    throw new UsageError(
      `--max-message-mib ${values['max-message-mib']}: give a whole number in [1, ${MAX_MESSAGE_MIB}]`,
    );
  }
  return {
    host,
    port,
    server: `${scheme}://${server}`,
    serverCa: ca === undefined ? undefined : readPem('--server-tls-ca', ca),
    tls:
      cert === undefined || key === undefined
        ? undefined
        : { cert: readPem('--tls-cert', cert), key: readPem('--tls-key', key) },
    page: values.page ?? new URL('../page', import.meta.url).pathname,
    allowedHosts: values['allow-host'],
    maxMessageBytes: mebibytes * MIB,
    maxBytesUnderWay: MESSAGES_UNDER_WAY * mebibytes * MIB,
  };
}

/**
 * Whether a Host header names this gateway. Pages of other sites cannot reach it by giving a name of
 * theirs the address of this machine.
 */
export function hostAllowed(header: string | undefined, options: GatewayOptions): boolean {
  const name = (header ?? '').replace(/:\d+$/, '').replace(/^\[|\]$/g, '');
  if (name === options.host || options.allowedHosts.includes(name)) return true;
  if (isLoopback(options.host)) return isLoopback(name);
  // An address is no name that somebody could have pointed here.
  return isIP(name) !== 0;
}
