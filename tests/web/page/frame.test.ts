import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { dropFile, keepScreenshot, openBrowser, openPage } from '../support/browser';
import { asObj, torus } from '../support/meshes';
import { ccst, Folder, newToken, Server, startGateway } from '../support/programs';

const folder = new Folder();
const server = new Server(folder);
const guardedFolder = new Folder();
const { token, line } = newToken('alice');
const root = process.env['CCST_ROOT'] ?? '';
let gateway: Awaited<ReturnType<typeof startGateway>>;
let browser: Browser;
let job = '';

beforeAll(async () => {
  await server.start();
  [gateway, browser] = await Promise.all([startGateway(server.address), openBrowser()]);
  writeFileSync(folder.file('torus.obj'), asObj(torus()));
  job = ccst(
    ...['sample', folder.file('torus.obj'), '-n', '500', '--server', server.address],
    ...['--detach', '--name', 'ring', '--label', 'project=x'],
  ).trim();
  ccst('watch', job, '--server', server.address, '--progress', 'none');
});

afterAll(async () => {
  await browser?.close();
  await gateway?.stop();
  await server.kill();
  folder.remove();
  guardedFolder.remove();
});

const axe = readFileSync(`${root}/build/web/node_modules/axe-core/axe.min.js`, 'utf8');

/** What axe finds wrong with the page as it is. */
async function violations(page: Page): Promise<string[]> {
  // Through the debugger, which the page's own policy does not bind.
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const { axe } = window as unknown as {
      axe: { run(): Promise<{ violations: { id: string; nodes: { html: string }[] }[] }> };
    };
    const found = await axe.run();
    return found.violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 120)).join(' | ')}`);
  });
}

for (const colorScheme of ['light', 'dark'] as const) {
  test.each(['/#/jobs', '/#/new', '/#/job', '/#/compare'])(
    `Frame.Page %s is accessible in ${colorScheme}`,
    async (place) => {
      const id = job.replace('jobs/', '');
      const path = place === '/#/job' ? `/#/jobs/${id}` : place === '/#/compare' ? `/#/compare/${id}/${id}` : place;
      const { page, errors, context } = await openPage(browser, gateway.url + path, { colorScheme });
      if (place === '/#/job') await page.waitForSelector('[data-result=shown]');
      if (place === '/#/jobs') await page.waitForSelector('table.jobs');
      await page.waitForSelector('.lamp.good');
      expect(await violations(page)).toEqual([]);
      expect(errors).toEqual([]);
      await keepScreenshot(page, `${place.slice(3)}-${colorScheme}`);
      await context.close();
    },
  );
}

test.each(['/#/jobs', '/#/new', '/#/job'])('Frame.Page %s fits a phone', async (place) => {
  const path = place === '/#/job' ? `/#/${job}` : place;
  const { page, context } = await openPage(browser, gateway.url + path, {
    viewport: { width: 360, height: 740 },
  });
  await page.waitForSelector('.lamp.good');
  if (place === '/#/job') await page.waitForSelector('[data-result=shown]');
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(360);
  expect(await violations(page)).toEqual([]);
  await keepScreenshot(page, `${place.slice(3)}-phone`);
  await context.close();
});

test('Frame.Job is made with the keyboard alone', async () => {
  const { page, context } = await openPage(browser, `${gateway.url}/#/new`);
  await page.waitForFunction(() => document.querySelectorAll('select option').length > 2);
  const focusOn = async (selector: string) => {
    for (let i = 0; i < 60; ++i) {
      await page.keyboard.press('Tab');
      if (await page.evaluate((s) => document.activeElement?.matches(s), selector)) return;
    }
    throw new Error(`Tab never reached ${selector}`);
  };
  await focusOn('.mesh-card select');
  await page.keyboard.press('ArrowDown');
  await focusOn('#option-count');
  await page.keyboard.press('Control+A');
  await page.keyboard.type('640');
  await page.keyboard.press('Enter');
  await page.waitForSelector('[data-result=shown]');
  expect(await page.locator('.tiles dd').first().textContent()).toBe('640');
  await focusOn('.view canvas');
  const before = await page.locator('.view').screenshot();
  await page.keyboard.press('ArrowLeft');
  await expect.poll(async () => before.equals(await page.locator('.view').screenshot())).toBe(false);
  await context.close();
});

test('Frame.Wrong options are named at their fields', async () => {
  const { page, context } = await openPage(browser, `${gateway.url}/#/new`);
  await page.click('text=Start the job');
  await page.waitForSelector('text=No mesh yet');
  await page.waitForFunction(() => document.querySelectorAll('select option').length > 2);
  await page.selectOption('.mesh-card select', { index: 1 });
  await page.fill('#option-count', '3');
  await page.click('text=Start the job');
  await page.waitForSelector('#option-count-wrong');
  expect(await page.evaluate(() => document.activeElement?.id)).toBe('option-count');
  // What only the server can judge comes back in words.
  await page.fill('#option-count', '999999999');
  await page.click('text=Start the job');
  await page.waitForSelector('text=Larger than this server takes');
  await context.close();
});

test('Frame.File that is no mesh is explained', async () => {
  const { page, context } = await openPage(browser, gateway.url);
  await dropFile(page, 'broken.off', 'OFF\n9 9 0\n');
  await page.waitForSelector('text=shorter than its counts');
  await keepScreenshot(page, 'broken-file');
  await page.click('text=Dismiss');
  await dropFile(page, 'notes.txt', 'hello');
  await page.waitForSelector('text=ends in one of');
  await context.close();
});

test('Frame.Filters leave what matches', async () => {
  const { page, context } = await openPage(browser, gateway.url);
  await page.waitForSelector('text=ring');
  await page.click('button:text-is("failed")');
  await page.waitForSelector('text=None like that');
  await page.click('button:text-is("all")');
  await page.fill('[aria-label=Labels]', 'project=x');
  await page.press('[aria-label=Labels]', 'Enter');
  await expect.poll(() => page.locator('table.jobs tbody tr').count()).toBe(1);
  await context.close();
});

test('Frame.Job that is not there is explained', async () => {
  const { page, context } = await openPage(browser, `${gateway.url}/#/jobs/none`);
  await page.waitForSelector('text=Not there');
  await keepScreenshot(page, 'not-there');
  await context.close();
});

test('Frame.Server that is gone is said in words', async () => {
  const lonely = new Server(new Folder());
  await lonely.start();
  const front = await startGateway(lonely.address);
  await lonely.kill();
  const { page, context } = await openPage(browser, front.url);
  await page.waitForSelector('.notice:has-text("The server cannot be reached")');
  await keepScreenshot(page, 'unreachable');
  await context.close();
  await front.stop();
});

test('Frame.Wrong token is explained and a right one lets in', async () => {
  writeFileSync(guardedFolder.file('tokens'), line);
  const guarded = new Server(guardedFolder, ['--auth-token-file', guardedFolder.file('tokens')]);
  await guarded.start();
  const front = await startGateway(guarded.address);
  const { page, context } = await openPage(browser, front.url);
  const enter = async (text: string) => {
    await page.click('.bar button:has-text("Token")');
    await page.fill('dialog input', text);
    await page.click('text=Use it');
  };
  await page.waitForSelector('.notice:has-text("The server asks for a token")');
  await enter('ccst_wrong');
  await page.waitForSelector('.notice:has-text("The server asks for a token")');
  await keepScreenshot(page, 'wrong-token');
  await enter(token);
  await page.waitForSelector('text=No jobs yet');
  await context.close();
  await front.stop();
  await guarded.kill();
});

test('Frame.Own JavaScript is under 400 KB', () => {
  const assets = `${root}/build/web/dist/page/assets`;
  const scripts = readdirSync(assets).filter((name) => name.endsWith('.js'));
  const bytes = scripts.reduce((sum, name) => sum + gzipSync(readFileSync(`${assets}/${name}`)).length, 0);
  console.log(`JavaScript, gzipped: ${(bytes / 1024).toFixed(0)} KB`);
  expect(scripts.length).toBeGreaterThan(2);
  expect(bytes).toBeLessThan(400_000);
});
