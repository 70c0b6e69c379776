import { execFileSync, spawn, type ChildProcess } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

const bin = process.env['CCST_BIN'] ?? 'build/release/bin';
const dist = fileURLToPath(new URL('../../../dist', import.meta.url));

/** The environment without settings of the user's. */
const environment = Object.fromEntries(
  Object.entries(process.env).filter(([name]) => !name.startsWith('CCST_')),
);

/** A folder that `remove` takes away. */
export class Folder {
  readonly path = mkdtempSync(join(tmpdir(), 'ccst-web-'));
  file(name: string): string {
    return join(this.path, name);
  }
  remove(): void {
    rmSync(this.path, { recursive: true, force: true });
  }
}

/** A program that says where it listens, and ends by its own process id. */
class Program {
  private constructor(
    private readonly process: ChildProcess,
    /** What followed each prefix. */
    readonly addresses: string[],
  ) {}

  static async start(command: string, args: string[], prefixes: string[]): Promise<Program> {
    const child = spawn(command, args, { env: environment, stdio: ['ignore', 'pipe', 'pipe'] });
    let log = '';
    child.stderr.on('data', (data: Buffer) => (log = (log + data.toString()).slice(-4000)));
    const addresses: string[] = [];
    for await (const line of createInterface({ input: child.stdout })) {
      const prefix = prefixes[addresses.length] ?? '';
      if (line.startsWith(prefix)) addresses.push(line.slice(prefix.length).trim());
      if (addresses.length === prefixes.length) return new Program(child, addresses);
    }
    throw new Error(`${command} ${args.join(' ')} ended before it listened: ${log}`);
  }

  get pid(): number {
    return this.process.pid ?? 0;
  }

  async stop(signal: NodeJS.Signals): Promise<void> {
    if (this.process.exitCode !== null || this.process.signalCode !== null) return;
    const ended = once(this.process, 'exit');
    this.process.kill(signal);
    await ended;
  }
}

/** The real ccst-server with its records in a folder. */
export class Server {
  private program: Program | undefined;
  /** Kept over restarts. */
  address = '127.0.0.1:0';
  private metrics = '';

  constructor(
    private readonly folder: Folder,
    private readonly flags: string[] = [],
  ) {}

  async start(): Promise<this> {
    this.program = await Program.start(
      join(bin, 'ccst-server'),
      ['--listen', this.address, '--data-dir', this.folder.file('data'), '--metrics-listen', '127.0.0.1:0', ...this.flags],
      ['listening on ', 'metrics on '],
    );
    [this.address = '', this.metrics = ''] = this.program.addresses;
    return this;
  }

  get pid(): number {
    return this.program?.pid ?? 0;
  }

  /** The value of a gauge or counter without labels. */
  async metric(name: string): Promise<number> {
    const page = await (await fetch(`http://${this.metrics}/metrics`)).text();
    return Number(new RegExp(`^${name} (.*)$`, 'm').exec(page)?.[1]);
  }

  async kill(): Promise<void> {
    await this.program?.stop('SIGKILL');
  }
}

/** The built gateway in front of a server. */
export async function startGateway(server: string, flags: string[] = []) {
  const program = await Program.start(
    process.execPath,
    [join(dist, 'gateway', 'main.js'), '--listen', '127.0.0.1:0', '--server', server, ...flags],
    ['dashboard on '],
  );
  return { url: program.addresses[0] ?? '', pid: program.pid, stop: () => program.stop('SIGTERM') };
}

/** Runs ccst and returns what it printed. @throws when it fails */
export function ccst(...args: string[]): string {
  return execFileSync(join(bin, 'ccst'), args, { env: environment, encoding: 'utf8', stdio: 'pipe' });
}

/** A new token, and the line that lets a server know it. */
export function newToken(name: string): { token: string; line: string } {
  const printed = execFileSync(join(bin, 'ccst-server'), ['--new-token', name], {
    env: environment,
    encoding: 'utf8',
  });
  return {
    token: /ccst_\w+/.exec(printed)?.[0] ?? '',
    line: printed.split('token-file: ').at(-1) ?? '',
  };
}
