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
    readonly address: string,
  ) {}

  static async start(command: string, args: string[], prefix: string): Promise<Program> {
    const child = spawn(command, args, { env: environment, stdio: ['ignore', 'pipe', 'pipe'] });
    let log = '';
    child.stderr?.on('data', (data: Buffer) => (log = (log + data.toString()).slice(-4000)));
    if (!child.stdout) throw new Error('no output');
    for await (const line of createInterface({ input: child.stdout })) {
      if (line.startsWith(prefix)) return new Program(child, line.slice(prefix.length).trim());
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

  constructor(
    private readonly folder: Folder,
    private readonly flags: string[] = [],
  ) {}

  async start(): Promise<this> {
    this.program = await Program.start(
      join(bin, 'ccst-server'),
      ['--listen', this.address, '--data-dir', this.folder.file('data'), ...this.flags],
      'listening on ',
    );
    this.address = this.program.address;
    return this;
  }

  get pid(): number {
    return this.program?.pid ?? 0;
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
    'dashboard on ',
  );
  return { url: program.address, pid: program.pid, stop: () => program.stop('SIGTERM') };
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
