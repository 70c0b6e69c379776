import { writeFileSync } from 'node:fs';
import { createClient } from '@connectrpc/connect';
import { createConnectTransport } from '@connectrpc/connect-node';
import type { Browser } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { Job_State } from '@api/job_pb';
import { SamplingService } from '@api/sampling_service_pb';
import { dropFile, openBrowser, openPage } from '../support/browser';
import { asObj, asOff, torus } from '../support/meshes';
import { ccst, Folder, Server, startGateway } from '../support/programs';

const folder = new Folder();
// One job at a time: those behind it wait until a test has done something to them.
const server = new Server(folder, ['--max-running-jobs', '1']);
let gateway: Awaited<ReturnType<typeof startGateway>>;
let browser: Browser;

beforeAll(async () => {
  await server.start();
  [gateway, browser] = await Promise.all([startGateway(server.address), openBrowser()]);
  writeFileSync(folder.file('torus.obj'), asObj(torus()));
});

afterAll(async () => {
  await browser?.close();
  await gateway?.stop();
  await server.kill();
  folder.remove();
});

const api = () =>
  createClient(SamplingService, createConnectTransport({ baseUrl: gateway.url, httpVersion: '1.1' }));
const startJob = (...options: string[]) =>
  ccst('sample', folder.file('torus.obj'), '--server', server.address, '--detach', ...options).trim();
const compareButton = 'text=Compare with Poisson disk and white noise';

test('Page.Reference jobs that were cancelled are computed again when asked for', async () => {
  const job = startJob('-n', '600', '--seed', '7');
  ccst('watch', job, '--server', server.address, '--progress', 'none');
  const ahead = startJob('-n', '400000', '--max-iterations', '10000', '--tolerance', '1e-300');
  const { page, context } = await openPage(browser, `${gateway.url}/#/${job}`);
  const columns = page.locator('table.quality thead th.number');
  const row = page.locator('tr:has(th:text("Smallest distance")) td');
  const measured = async () => (await row.allTextContents()).filter((t) => Number(t) > 0).length;

  await page.click(compareButton);
  const labels = { 'reference-of': job.replace('jobs/', '') };
  const references = async () => (await api().listJobs({ labels })).jobs;
  await expect.poll(async () => (await references()).length, { timeout: 20_000 }).toBe(2);
  for (const { name } of await references()) await api().cancelJob({ name });
  await page.waitForSelector('.notice.bad:has-text("The job left no samples")');
  await expect.poll(() => columns.allTextContents().then((t) => t.map((s) => s.trim()))).toEqual(['This job']);

  ccst('cancel', ahead, '--server', server.address);
  await page.click(compareButton);
  await expect.poll(measured, { timeout: 20_000 }).toBe(3);
  expect(await page.locator('.notice.bad').count()).toBe(0);
  // A page opened later shows those that have samples, not those that have none.
  await page.reload();
  await expect.poll(measured, { timeout: 20_000 }).toBe(3);
  const states = (await references()).map((reference) => reference.state).sort();
  const { SUCCEEDED, CANCELLED } = Job_State;
  expect(states).toEqual([SUCCEEDED, SUCCEEDED, CANCELLED, CANCELLED].sort());
  await context.close();
});

test('Page.Dropped mesh with more vertices than corners becomes a job', async () => {
  const corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];
  const alone = Array.from({ length: 9000 }, (_, i) => [i, i * i, -i]);
  const text = asOff({ positions: [...alone, ...corners], faces: [[9000, 9001, 9002]] });
  const { page, context } = await openPage(browser, gateway.url);
  await dropFile(page, 'sparse.off', text);
  await page.waitForSelector('[data-result=shown]');
  expect(await page.locator('h1 .state').textContent()).toBe('succeeded');
  await context.close();
});
