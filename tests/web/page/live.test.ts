import { readFileSync, writeFileSync } from 'node:fs';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { dropFile, keepScreenshot, openBrowser, openPage, seriesDrawn } from '../support/browser';
import { asObj, asOff, torus } from '../support/meshes';
import { ccst, Folder, Server, startGateway } from '../support/programs';

const folder = new Folder();
const server = new Server(folder);
let gateway: Awaited<ReturnType<typeof startGateway>>;
let browser: Browser;
let mesh = '';

beforeAll(async () => {
  await server.start();
  [gateway, browser] = await Promise.all([startGateway(server.address), openBrowser()]);
  writeFileSync(folder.file('torus.obj'), asObj(torus()));
  mesh = ccst('upload', folder.file('torus.obj'), '--server', server.address).trim();
});

afterAll(async () => {
  await browser?.close();
  await gateway?.stop();
  await server.kill();
  folder.remove();
});

/** Starts a job with the command; `jobs/{uuid}`. */
function startJob(...options: string[]): string {
  expect(mesh).toMatch(/^meshes\//);
  const file = folder.file('torus.obj');
  return ccst('sample', file, '--server', server.address, '--detach', ...options).trim();
}

/** One that takes so long that a test can do something in the middle. */
const lasting = (seed: number) =>
  startJob('-n', '400000', '--seed', String(seed), '--max-iterations', '10000', '--tolerance', '1e-300');

const urlOf = (job: string) => `${gateway.url}/#/${job}`;
const stateOf = (page: Page) => page.locator('h1 .state').textContent();
const points = (page: Page) =>
  page.locator('.chart.variation').evaluate((chart) => Number((chart as HTMLElement).dataset['points']));

test('Page.Dropped mesh becomes a job that is drawn', async () => {
  const { page, errors, context } = await openPage(browser, gateway.url);
  await page.waitForSelector('text=No jobs yet');
  await keepScreenshot(page, 'no-jobs');
  await dropFile(page, 'torus.off', asOff(torus()));
  await page.waitForSelector('[data-result=shown]');
  expect(await stateOf(page)).toBe('succeeded');
  expect(await page.locator('h1').textContent()).toContain('torus.off');
  expect(await page.locator('.view').getAttribute('data-points')).toBe('5000');
  await page.waitForSelector('th:has-text("5 to 7 neighbours")');
  await keepScreenshot(page, 'job');
  expect(errors).toEqual([]);
  await context.close();
});

test('Page.Chart grows while the job runs', async () => {
  const job = lasting(1);
  const { page, errors, context } = await openPage(browser, urlOf(job));
  // Every length the chart ever had.
  await page.locator('.chart.variation').evaluate((chart) => {
    const lengths: number[] = ((window as unknown as { lengths: number[] }).lengths = []);
    const note = () => lengths.push(Number((chart as HTMLElement).dataset['points']));
    new MutationObserver(note).observe(chart, { attributeFilter: ['data-points'] });
  });
  // What came before the page was open arrives at once.
  const before = await points(page);
  await expect.poll(() => points(page), { timeout: 30_000 }).toBeGreaterThan(before + 5);
  expect(await stateOf(page)).toBe('running');
  const lengths = await page.evaluate(() => (window as unknown as { lengths: number[] }).lengths);
  const different = [...new Set(lengths)];
  expect(different.length).toBeGreaterThan(3);
  expect(different).toEqual([...different].sort((a, b) => a - b));
  expect(await page.locator('.view-card').getAttribute('data-previews')).toMatch(/^\d+$/);
  await keepScreenshot(page, 'running');

  await page.click('button:text-is("Cancel")');
  await expect.poll(() => stateOf(page), { timeout: 10_000 }).toBe('cancelled');
  expect(errors).toEqual([]);
  await context.close();
});

test('Page.Reload in the middle shows the whole run', async () => {
  const job = lasting(2);
  const { page, context } = await openPage(browser, urlOf(job));
  await expect.poll(() => points(page), { timeout: 30_000 }).toBeGreaterThan(3);
  const before = await points(page);
  await page.reload();
  await expect.poll(() => points(page), { timeout: 30_000 }).toBeGreaterThan(before);
  ccst('cancel', job, '--server', server.address);
  await expect.poll(() => stateOf(page), { timeout: 10_000 }).toBe('cancelled');
  await context.close();
});

test('Page.Two tabs show one job alike', async () => {
  const job = lasting(3);
  const first = await openPage(browser, urlOf(job));
  const second = await first.context.newPage();
  await second.goto(urlOf(job));
  await expect.poll(() => points(second), { timeout: 30_000 }).toBeGreaterThan(3);
  await second.click('button:text-is("Cancel")');
  for (const page of [first.page, second]) {
    await expect.poll(() => stateOf(page), { timeout: 10_000 }).toBe('cancelled');
  }
  await expect.poll(async () => (await points(first.page)) - (await points(second))).toBe(0);
  await first.context.close();
});

test('Page.Server that is killed and comes back goes on where it was', async () => {
  const job = startJob('-n', '300000', '--seed', '5');
  const { page, context } = await openPage(browser, urlOf(job));
  await expect.poll(() => points(page), { timeout: 30_000 }).toBeGreaterThan(3);
  await server.kill();
  await page.waitForSelector('text=Reconnecting');
  expect(await points(page)).toBeGreaterThan(3);
  await keepScreenshot(page, 'reconnecting');
  await server.start();
  await expect.poll(() => stateOf(page), { timeout: 60_000 }).toBe('succeeded');
  await expect.poll(() => page.locator('text=Reconnecting').count()).toBe(0);
  // The run was repeated; the initial set and every alternation are shown once.
  const alternations = Number(await page.locator('.tiles div:nth-child(2) dd').textContent());
  expect(await points(page)).toBe(alternations + 1);
  await context.close();
});

test('Page.Downloaded files are those of the command', async () => {
  const job = startJob('-n', '600', '--seed', '7');
  const { page, context } = await openPage(browser, urlOf(job));
  await page.waitForSelector('summary:has-text("Download")');
  const download = async (words: string) => {
    await page.click('summary:has-text("Download")');
    const [file] = await Promise.all([
      page.waitForEvent('download'),
      page.click(`.menu-items button:has-text("${words}")`),
    ]);
    const path = folder.file(file.suggestedFilename());
    await file.saveAs(path);
    return path;
  };
  const samples = await download('Samples .csv');
  const fetched = folder.file('fetched.csv');
  ccst('fetch', job, '--server', server.address, '-o', fetched);
  const rows = (file: string) =>
    readFileSync(file, 'utf8').trim().split('\n').slice(1).map((row) => row.split(',').map(Number));
  const [ours, theirs] = [rows(samples), rows(fetched)];
  expect(ours.length).toBe(600);
  // Positions are 32-bit floats here; faces and weights are exact.
  ours.forEach((row, i) => {
    expect(row.slice(6)).toEqual(theirs[i]?.slice(6));
    row.slice(0, 3).forEach((x, k) => expect(Math.abs(x - (theirs[i]?.[k] ?? NaN))).toBeLessThan(1e-6));
  });
  for (const words of ['Mesh .ply', 'Mesh .obj', 'Mesh .glb']) {
    const summary = folder.file('summary.json');
    ccst('sample', await download(words), '-n', '50', '--local', '--summary', summary, '--progress', 'none');
    const { surface } = JSON.parse(readFileSync(summary, 'utf8'));
    expect(surface).toMatchObject({ vertices: 600, faces: 1200, euler: 0, boundary_loops: 0 });
  }
  await context.close();
});

test('Page.Two jobs are compared side by side', async () => {
  const jobs = [startJob('-n', '600', '--seed', '7'), startJob('-n', '600', '--method', 'white')];
  for (const job of jobs) ccst('watch', job, '--server', server.address, '--progress', 'none');
  const { page, errors, context } = await openPage(browser, gateway.url);
  for (const job of jobs) await page.check(`tr:has(a[href="#/${job}"]) input`);
  await page.click('text=Compare the two');
  await expect.poll(() => page.locator('[data-result=shown]').count(), { timeout: 20_000 }).toBe(2);
  const row = page.locator('tr:has(th:text("Mean nearest distance")) td');
  await expect.poll(() => row.allTextContents()).toHaveLength(2);
  await expect
    .poll(async () => (await row.allTextContents()).every((text) => Number(text) > 0.3))
    .toBe(true);
  const [ccstMean = 0, whiteMean = 0] = (await row.allTextContents()).map(Number);
  expect(ccstMean).toBeGreaterThan(whiteMean);
  await keepScreenshot(page, 'compare');
  expect(errors).toEqual([]);
  await context.close();
});

test('Page.Reference jobs stand beside the job', async () => {
  const job = startJob('-n', '600', '--seed', '7');
  const { page, context } = await openPage(browser, urlOf(job));
  await page.click('text=Compare with Poisson disk and white noise');
  const row = page.locator('tr:has(th:text("Smallest distance")) td');
  await expect
    .poll(async () => (await row.allTextContents()).filter((t) => Number(t) > 0).length, { timeout: 20_000 })
    .toBe(3);
  // Found again by their label.
  await page.reload();
  await expect.poll(() => row.count(), { timeout: 20_000 }).toBe(3);
  await keepScreenshot(page, 'quality');
  await context.close();
});

test('Page.Curves of the references lie over those of the job', async () => {
  const job = startJob('-n', '600', '--seed', '8');
  const { page, errors, context } = await openPage(browser, urlOf(job));
  await page.click('text=Compare with Poisson disk and white noise');
  const all = ['This job', 'Poisson disk', 'White noise'];
  for (const title of ['Radial mean', 'Anisotropy', 'Power spectrum']) {
    await expect.poll(() => seriesDrawn(page, title), { timeout: 20_000 }).toEqual(all);
  }
  // The others have no triangles.
  await expect.poll(() => seriesDrawn(page, 'Angles')).toEqual(['This job']);
  // Plot and legend fill the box, however many lines the legend takes.
  const left = await page.locator('.chart').evaluateAll((charts) =>
    charts.map((c) => c.clientHeight - (c.querySelector<HTMLElement>('.uplot')?.offsetHeight ?? 0)),
  );
  for (const pixels of left) expect(Math.abs(pixels)).toBeLessThan(10);
  await keepScreenshot(page, 'curves');
  expect(errors).toEqual([]);
  await context.close();
});

test('Page.Poisson disks have a spectrum', async () => {
  const job = startJob('-n', '600', '--method', 'poisson');
  const { page, errors, context } = await openPage(browser, urlOf(job));
  for (const title of ['Radial mean', 'Power spectrum']) {
    await expect.poll(() => seriesDrawn(page, title), { timeout: 20_000 }).toEqual(['This job']);
  }
  expect(await seriesDrawn(page, 'Angles')).toEqual([]);
  expect(errors).toEqual([]);
  await context.close();
});
