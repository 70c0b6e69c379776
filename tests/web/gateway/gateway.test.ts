import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { createServer, request } from 'node:http';
import * as https from 'node:https';
import type { AddressInfo } from 'node:net';
import { createClient } from '@connectrpc/connect';
import { createConnectTransport } from '@connectrpc/connect-node';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { Job_State } from '@api/job_pb';
import { SamplingService } from '@api/sampling_service_pb';
import { ccst, Folder, Server, startGateway } from '../support/programs';
import { asObj, torus } from '../support/meshes';

const folder = new Folder();
const server = new Server(folder);
let gateway: Awaited<ReturnType<typeof startGateway>>;
let mesh = '';

beforeAll(async () => {
  await server.start();
  gateway = await startGateway(server.address);
  writeFileSync(folder.file('torus.obj'), asObj(torus()));
  mesh = ccst('upload', folder.file('torus.obj'), '--server', server.address).trim();
});

afterAll(async () => {
  await gateway?.stop();
  await server.kill();
  folder.remove();
});

const jobs = () =>
  createClient(SamplingService, createConnectTransport({ baseUrl: gateway.url, httpVersion: '1.1' }));

function call(path: string, body: unknown, headers: Record<string, string> = {}) {
  return fetch(`${gateway.url}/${path}`, {
    method: 'POST',
    headers: { 'content-type': 'application/json', ...headers },
    body: JSON.stringify(body),
  });
}

/** A GET with headers that fetch would not send. */
function get(path: string, headers: Record<string, string>): Promise<number> {
  return new Promise((resolve, reject) => {
    request(gateway.url + path, { headers }, (response) => {
      response.resume();
      resolve(response.statusCode ?? 0);
    })
      .on('error', reject)
      .end();
  });
}

const endless = { maxIterations: 10000, relativeTolerance: 1e-300 };

test('Gateway.Unary call in JSON is answered', async () => {
  const answer = await call('ccst.v1.ServerInfoService/GetServerInfo', {});
  expect(answer.status).toBe(200);
  expect(Number((await answer.json()).limits.maxSampleCount)).toBeGreaterThan(0);
});

test('Gateway.Error of the server keeps its code and details', async () => {
  const answer = await call('ccst.v1.SamplingService/GetJob', { name: 'jobs/none' });
  expect(answer.status).toBe(404);
  const { code, details } = await answer.json();
  expect(code).toBe('not_found');
  expect(details[0].type).toBe('ccst.v1.ErrorInfo');
});

test('Gateway.Stream arrives message by message', async () => {
  const { job } = await jobs().createJob({
    spec: { mesh, options: { sampleCount: 200000n, ...endless } },
  });
  const leave = new AbortController();
  let reports = 0;
  const watching = jobs().watchJob({ name: job?.name ?? '' }, { signal: leave.signal });
  for await (const { event } of watching) {
    if (event.case === 'progress' && ++reports === 5) break;
  }
  // The job never ends by itself: what arrived did so while it ran.
  const now = await jobs().getJob({ name: job?.name ?? '' });
  expect(now.job?.state).toBe(Job_State.RUNNING);
  await jobs().cancelJob({ name: job?.name ?? '' });
});

test('Gateway.Caller that goes away takes its stream along', async () => {
  const { job } = await jobs().createJob({
    spec: { mesh, options: { sampleCount: 200000n, seed: 1n, ...endless } },
  });
  const name = job?.name ?? '';
  const leave = new AbortController();
  const watching = async () => {
    for await (const { event } of jobs().watchJob({ name }, { signal: leave.signal })) {
      if (event.case !== 'progress') continue;
      expect(await server.metric('ccst_watchers')).toBe(1);
      leave.abort();
    }
  };
  await watching().catch((error: unknown) => {
    if (!leave.signal.aborted) throw error;
  });
  await expect.poll(() => server.metric('ccst_watchers'), { timeout: 5000 }).toBe(0);
  await jobs().cancelJob({ name });
});

test('Gateway.Page and what it needs are served under a strict policy', async () => {
  const answer = await fetch(gateway.url + '/');
  expect(answer.status).toBe(200);
  expect(await answer.text()).toContain('<div id="app">');
  const policy = answer.headers.get('content-security-policy') ?? '';
  expect(policy).toContain("default-src 'none'");
  expect(policy).not.toContain('unsafe-inline');
  expect(policy).not.toContain("'unsafe-eval'");
  expect(answer.headers.get('x-content-type-options')).toBe('nosniff');
});

test.each(['/main.js', '/../package.json', '/%2e%2e/package.json', '/grpc.health.v1.Health/Check'])(
  'Gateway.Nothing but the page is served: %s',
  async (path) => {
    expect(await get(path, {})).toBe(404);
  },
);

test('Gateway.Names of other sites are not answered', async () => {
  expect(await get('/', { host: 'example.com' })).toBe(421);
  expect(await get('/', { host: 'localhost' })).toBe(200);
});

test('Gateway.Pages of other sites may not call', async () => {
  const answer = await call('ccst.v1.SamplingService/ListJobs', {}, { origin: 'http://example.com' });
  expect(answer.status).toBe(403);
  expect(await get('/', { origin: 'null' })).toBe(403);
});

test('Gateway.Health follows the server', async () => {
  expect((await fetch(gateway.url + '/healthz')).status).toBe(200);
  // A port that was just free, where nobody listens.
  const probe = createServer();
  await new Promise<void>((resolve) => probe.listen(0, '127.0.0.1', resolve));
  const { port } = probe.address() as AddressInfo;
  await new Promise((resolve) => probe.close(resolve));
  const lonely = await startGateway(`127.0.0.1:${port}`);
  expect((await fetch(lonely.url + '/healthz')).status).toBe(503);
  await lonely.stop();
});

test('Gateway.Encryption holds on both sides', async () => {
  const [cert, key] = [folder.file('cert.pem'), folder.file('key.pem')];
  execFileSync('openssl', [
    ...'req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 1 -subj /CN=test'.split(' '),
    ...['-addext', 'subjectAltName=IP:127.0.0.1', '-out', cert, '-keyout', key],
  ], { stdio: 'pipe' });
  const other = new Folder();
  const secret = new Server(other, ['--tls-cert', cert, '--tls-key', key]);
  await secret.start();
  const flags = ['--server-tls-ca', cert, '--tls-cert', cert, '--tls-key', key];
  const front = await startGateway(secret.address, flags);
  expect(front.url).toMatch(/^https:/);
  const status = await new Promise<number>((resolve, reject) => {
    https
      .get(front.url + '/healthz', { ca: readFileSync(cert) }, (response) => {
        response.resume();
        resolve(response.statusCode ?? 0);
      })
      .on('error', reject);
  });
  expect(status).toBe(200);
  await front.stop();
  await secret.kill();
  other.remove();
});
