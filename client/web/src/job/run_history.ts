import type { IterationProgress } from '@api/job_pb';

/** What the charts show of a run: one entry an alternation, in order, none twice. */
export class RunHistory {
  readonly iterations: number[] = [];
  readonly energies: number[] = [];
  readonly capacityCvs: number[] = [];
  readonly flips: number[] = [];
  readonly relocations: number[] = [];
  /** Computation time so far, in seconds. */
  readonly elapsed: number[] = [];
  private sequence = 0n;
  private last: IterationProgress | undefined;

  /** The last one taken; a watch that starts again continues after it. */
  get lastSequence(): bigint {
    return this.sequence;
  }

  /** The report taken last. */
  get latest(): IterationProgress | undefined {
    return this.last;
  }

  get length(): number {
    return this.iterations.length;
  }

  /** Takes a report unless it was taken before; says which. */
  add(sequence: bigint, progress: IterationProgress): boolean {
    if (sequence <= this.sequence) return false;
    this.sequence = sequence;
    this.last = progress;
    this.iterations.push(progress.iteration);
    this.energies.push(progress.energy);
    this.capacityCvs.push(progress.capacityCv);
    this.flips.push(Number(progress.flipCount));
    this.relocations.push(Number(progress.relocationCount));
    this.elapsed.push(seconds(progress.elapsedDuration));
    return true;
  }
}

/** A duration of the API in seconds; 0 when unset. */
export function seconds(duration: { seconds: bigint; nanos: number } | undefined): number {
  return duration ? Number(duration.seconds) + duration.nanos / 1e9 : 0;
}
