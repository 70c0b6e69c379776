import { mkdirSync } from 'node:fs';
import { chromium, type Browser, type BrowserContextOptions, type Page } from 'playwright-core';

const FLAGS = [
  '--no-sandbox',
  // WebGL without a graphics card.
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

export function openBrowser(): Promise<Browser> {
  const executablePath = process.env['CCST_CHROMIUM'] ?? '/usr/bin/chromium';
  return chromium.launch({ executablePath, args: FLAGS });
}

/** A page in a context of its own, and every error that its console shows. */
export async function openPage(browser: Browser, url: string, options: BrowserContextOptions = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 1000 }, ...options });
  const page = await context.newPage();
  const errors = recordErrors(page);
  await page.goto(url);
  await page.waitForSelector('h1');
  return { context, page, errors };
}

/** What the console of `page` shows as errors from now on. */
export function recordErrors(page: Page): string[] {
  const errors: string[] = [];
  page.on('pageerror', (error) => errors.push(error.message));
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  return errors;
}

/** Lets go of a file over an element, as a mouse does. */
export async function dropFile(page: Page, name: string, text: string, onto = 'main'): Promise<void> {
  await page.locator(onto).evaluate(
    (element, file) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([file.text], file.name));
      for (const type of ['dragover', 'drop']) {
        element.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
      }
    },
    { name, text },
  );
}

/** Keeps a picture for people to look at, in build/web/screenshots. */
export async function keepScreenshot(page: Page, name: string): Promise<void> {
  const folder = `${process.env['CCST_ROOT']}/build/web/screenshots`;
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: `${folder}/${name}.png`, fullPage: true });
}

/** The series of the chart under `title` that are on its canvas, by the words of the legend. */
export async function seriesDrawn(page: Page, title: string): Promise<string[]> {
  const charts = page.locator(`figure:has(figcaption:text-is("${title}")) .chart`);
  if ((await charts.count()) === 0) return [];
  return charts.first().evaluate((chart) => {
    const canvas = chart.querySelector('canvas');
    const context = canvas?.getContext('2d');
    if (!canvas || !context || canvas.width === 0) return [];
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const labels = [...chart.querySelectorAll('.u-series .u-label')].slice(1);
    return labels.flatMap((label, i) => {
      const colour = getComputedStyle(chart).getPropertyValue(`--chart-${i + 1}`);
      const rgb = (colour.match(/[\d.]+/g) ?? []).map(Number);
      let pixels = 0;
      for (let at = 0; at < data.length; at += 4) {
        const distance = rgb.reduce((sum, c, k) => sum + Math.abs(c - (data[at + k] ?? 0)), 0);
        if (data[at + 3] === 255 && distance < 12) ++pixels;
      }
      return pixels > 20 ? [label.textContent ?? ''] : [];
    });
  });
}
