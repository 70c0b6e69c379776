import { render, type TemplateResult } from 'lit-html';

/** A page of the dashboard: what it shows, and how it ends. */
export interface Page {
  title: string;
  /** Called when the user goes elsewhere. */
  leave(): void;
}

/** Draws templates into a box, once a frame however often it is asked. */
export class Painter {
  private frame = 0;
  constructor(
    private readonly box: HTMLElement,
    private readonly template: () => TemplateResult,
  ) {}

  /** Draws with the next frame. */
  readonly later = (): void => {
    this.frame ||= requestAnimationFrame(() => this.now());
  };

  /** Draws at once. */
  now(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    render(this.template(), this.box);
  }

  stop(): void {
    cancelAnimationFrame(this.frame);
  }
}

/** The element that must be there. */
export function find<T extends HTMLElement>(box: ParentNode, selector: string): T {
  const element = box.querySelector<T>(selector);
  if (!element) throw new Error(`no ${selector}`);
  return element;
}

/** Calls `work` now and then until the signal fires; never twice at once. */
export async function repeat(
  work: () => Promise<void>,
  everyMs: number,
  signal: AbortSignal,
): Promise<void> {
  while (!signal.aborted) {
    await work();
    await wait(everyMs, signal);
  }
}

/** Resolves after a time, or as soon as the signal fires. */
export function wait(milliseconds: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    const timer = setTimeout(done, milliseconds);
    function done(): void {
      clearTimeout(timer);
      signal.removeEventListener('abort', done);
      resolve();
    }
    if (signal.aborted) done();
    else signal.addEventListener('abort', done);
  });
}
