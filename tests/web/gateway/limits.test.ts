// What callers can make the gateway hold: sent as bytes, without a client that would be reasonable.
import { createHash } from 'node:crypto';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { Agent, request, type ClientRequest } from 'node:http';
import * as http2 from 'node:http2';
import { gzipSync } from 'node:zlib';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { Folder, newToken, Server, startGateway } from '../support/programs';

const KIB = 1024;
const MIB = 1024 * KIB;
const SERVERS_MESH_LIMIT = 3 * MIB;
const INFO = '/ccst.v1.ServerInfoService/GetServerInfo';
const CREATE_MESH = '/ccst.v1.MeshService/CreateMesh';

const folder = new Folder();
const alice = newToken('alice');
writeFileSync(folder.file('tokens'), alice.line);
const server = new Server(folder, [
  ...['--auth-token-file', folder.file('tokens')],
  ...['--max-inline-mesh-bytes', String(SERVERS_MESH_LIMIT)],
]);
let gateway: Awaited<ReturnType<typeof startGateway>>;

beforeAll(async () => {
  await server.start();
  gateway = await startGateway(server.address, ['--max-message-mib', '8']);
});

afterAll(async () => {
  await gateway?.stop();
  await server.kill();
  folder.remove();
});

interface Answer {
  status: number;
  code: string;
  message: string;
}

const PROTO = { 'content-type': 'application/proto', 'connect-protocol-version': '1' };
const authorized = { authorization: `Bearer ${alice.token}` };

/** Begins a call on a connection of its own and sends nothing of its body. */
function begin(path: string, headers: Record<string, string | number>): { call: ClientRequest; answer: Promise<Answer> } {
  const call = request(gateway.url + path, {
    method: 'POST',
    headers: { ...PROTO, ...headers },
    agent: new Agent(),
  });
  const answer = new Promise<Answer>((resolve, reject) => {
    call.on('error', reject);
    call.on('response', async (response) => {
      const parts: Buffer[] = [];
      for await (const part of response) parts.push(part as Buffer);
      const text = Buffer.concat(parts).toString();
      const { code = '', message = '' } = text.startsWith('{') ? JSON.parse(text) : {};
      resolve({ status: response.statusCode ?? 0, code, message });
    });
  });
  call.flushHeaders();
  return { call, answer };
}

/** Sends a whole call. */
function send(path: string, body: Buffer, headers: Record<string, string | number> = {}): Promise<Answer> {
  const { call, answer } = begin(path, { 'content-length': body.length, ...headers });
  call.end(body);
  return answer;
}

/** A CreateMeshRequest of `size` bytes that are no mesh, written by hand. */
function createMesh(size: number): Buffer {
  const data = Buffer.alloc(size, 'x');
  const varint = (value: number): number[] =>
    value < 128 ? [value] : [(value % 128) + 128, ...varint(Math.floor(value / 128))];
  const field = (number: number, bytes: Buffer) =>
    Buffer.concat([Buffer.from([number * 8 + 2, ...varint(bytes.length)]), bytes]);
  const sha256 = Buffer.from(createHash('sha256').update(data).digest('hex'));
  const digest = Buffer.concat([field(1, sha256), Buffer.from([16, ...varint(size)])]);
  return Buffer.concat([field(1, Buffer.concat([field(1, digest), Buffer.from([16, 1])])), field(2, data)]);
}

function residentBytes(): number {
  const status = readFileSync(`/proc/${gateway.pid}/status`, 'utf8');
  return Number(/VmHWM:\s+(\d+)/.exec(status)?.[1]) * KIB;
}

test('GatewayLimits.Compressed requests are refused unread', async () => {
  const before = residentBytes();
  const bomb = gzipSync(Buffer.alloc(100 * MIB));
  for (const name of ['content-encoding', 'connect-content-encoding', 'grpc-encoding']) {
    const answer = await send(INFO, bomb, { [name]: 'gzip' });
    expect(answer).toMatchObject({ status: 501, code: 'unimplemented' });
  }
  expect((await send(INFO, Buffer.alloc(0), { 'content-encoding': 'identity', ...authorized })).status).toBe(200);
  expect(residentBytes() - before).toBeLessThan(40 * MIB);
});

test('GatewayLimits.Requests that are small by nature have a small limit', async () => {
  const answer = await send(INFO, Buffer.alloc(256 * KIB + 1), authorized);
  expect(answer).toMatchObject({ status: 429, code: 'resource_exhausted' });
  expect(answer.message).toContain('GetServerInfo');
});

test('GatewayLimits.A body without a length has the same limits', async () => {
  const { call, answer } = begin(INFO, { 'transfer-encoding': 'chunked', ...authorized });
  call.end(Buffer.alloc(MIB));
  expect(await answer).toMatchObject({ status: 429, code: 'resource_exhausted' });
});

test('GatewayLimits.A mesh has the limit of the server behind', async () => {
  // Within the limit it reaches the server, which finds that the bytes are no mesh.
  const within = await send(CREATE_MESH, createMesh(SERVERS_MESH_LIMIT), authorized);
  expect(within).toMatchObject({ status: 400, code: 'invalid_argument' });
  expect(within.message).toContain('DRACO');
  const over = await send(CREATE_MESH, createMesh(SERVERS_MESH_LIMIT + 2 * MIB), authorized);
  expect(over).toMatchObject({ status: 429, code: 'resource_exhausted' });
  expect(over.message).toContain('the server takes at most');
});

test('GatewayLimits.A large body of a stranger is refused before it comes', async () => {
  for (const headers of [{}, { authorization: 'Bearer ccst_wrong' }]) {
    const { answer, call } = begin(CREATE_MESH, { 'content-length': MIB, ...headers });
    expect(await answer).toMatchObject({ status: 401, code: 'unauthenticated' });
    call.destroy();
  }
});

test('GatewayLimits.Bytes under way are bounded, and free once a call ends', async () => {
  // Two of the largest fit; a third does not, and its sender may come again.
  const size = createMesh(SERVERS_MESH_LIMIT).length;
  const held = [1, 2, 3, 4, 5].map(() => begin(CREATE_MESH, { 'content-length': size, ...authorized }));
  for (const { answer } of held) answer.catch(() => {});
  await expect
    .poll(async () => (await send(CREATE_MESH, createMesh(SERVERS_MESH_LIMIT), authorized)).status)
    .toBe(429);
  expect((await send(INFO, Buffer.alloc(0), authorized)).status).toBe(200);
  for (const { call } of held) call.destroy();
  await expect
    .poll(async () => (await send(CREATE_MESH, createMesh(SERVERS_MESH_LIMIT), authorized)).status)
    .toBe(400);
});

test('GatewayLimits.One connection holds no more than one of the largest', async () => {
  const [cert, key] = [folder.file('cert.pem'), folder.file('key.pem')];
  execFileSync(
    'openssl',
    [
      ...'req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 1 -subj /CN=test'.split(' '),
      ...['-addext', 'subjectAltName=IP:127.0.0.1', '-out', cert, '-keyout', key],
    ],
    { stdio: 'pipe' },
  );
  const secure = await startGateway(server.address, [
    ...['--max-message-mib', '4', '--tls-cert', cert, '--tls-key', key],
  ]);
  const session = http2.connect(secure.url, { ca: readFileSync(cert) });
  const status = (bytes: number) =>
    new Promise<number>((resolve, reject) => {
      const stream = session.request({
        ':method': 'POST',
        ':path': CREATE_MESH,
        'content-length': bytes,
        ...PROTO,
        ...authorized,
      });
      stream.on('error', reject);
      stream.on('response', (headers) => resolve(Number(headers[':status'])));
      stream.resume();
    });
  const first = status(3 * MIB);
  first.catch(() => {});
  // The first is there once the second does not fit beside it.
  await expect.poll(() => status(2 * MIB), { timeout: 10_000 }).toBe(429);
  session.destroy();
  await secure.stop();
});
