/** Area of each triangle, M. */
export function triangleAreas(positions: Float32Array, indices: Uint32Array): Float32Array {
  const areas = new Float32Array(indices.length / 3);
  const p = (corner: number, axis: number) => positions[3 * (indices[corner] ?? 0) + axis] ?? 0;
  for (let t = 0; t < areas.length; ++t) {
    const [a, b, c] = [3 * t, 3 * t + 1, 3 * t + 2];
    const [ux, uy, uz] = [p(b, 0) - p(a, 0), p(b, 1) - p(a, 1), p(b, 2) - p(a, 2)];
    const [vx, vy, vz] = [p(c, 0) - p(a, 0), p(c, 1) - p(a, 1), p(c, 2) - p(a, 2)];
    areas[t] = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
  }
  return areas;
}

/** Mean area of the triangles around each sample, N; NaN at samples without triangles. */
export function meanAreaAround(areas: Float32Array, indices: Uint32Array, count: number): Float32Array {
  const sums = new Float32Array(count);
  const uses = new Uint16Array(count);
  for (let k = 0; k < indices.length; ++k) {
    const sample = indices[k] ?? 0;
    sums[sample] = (sums[sample] ?? 0) + (areas[Math.floor(k / 3)] ?? 0);
    uses[sample] = (uses[sample] ?? 0) + 1;
  }
  return sums.map((sum, i) => sum / (uses[i] ?? 0));
}

/**
 * Distance of each sample to its nearest other one, N; Infinity for a single one. Cells of a sample or
 * so each are searched in shells around it, which costs O(N) for samples on surfaces.
 */
export function nearestDistances(positions: Float32Array): Float32Array {
  const grid = new SampleGrid(positions);
  return Float32Array.from({ length: positions.length / 3 }, (_, i) => grid.nearest(i));
}

/** Samples by the cell they lie in. Cells share buckets: what a bucket has too much is only looked at. */
class SampleGrid {
  private readonly low: number[];
  private readonly size: number;
  private readonly cells: number[];
  private readonly first: Int32Array;
  private readonly next: Int32Array;

  constructor(private readonly positions: Float32Array) {
    const count = positions.length / 3;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let k = 0; k < positions.length; ++k) {
      const value = positions[k] ?? 0;
      if (value < (low[k % 3] ?? 0)) low[k % 3] = value;
      if (value > (high[k % 3] ?? 0)) high[k % 3] = value;
    }
    this.low = low;
    const extents = low.map((l, k) => (high[k] ?? 0) - l);
    // A surface fills about as many cells of this size as it has samples.
    this.size = Math.max(...extents, Number.MIN_VALUE) / Math.max(1, Math.sqrt(count));
    this.cells = extents.map((extent) => Math.floor(extent / this.size));
    this.first = new Int32Array(2 ** Math.ceil(Math.log2(count + 1))).fill(-1);
    this.next = new Int32Array(count);
    for (let i = 0; i < count; ++i) {
      const bucket = this.bucket(this.cell(i, 0), this.cell(i, 1), this.cell(i, 2));
      this.next[i] = this.first[bucket] ?? -1;
      this.first[bucket] = i;
    }
  }

  nearest(i: number): number {
    const [x, y, z] = [this.cell(i, 0), this.cell(i, 1), this.cell(i, 2)];
    const furthest = Math.max(...this.cells) + 1;
    let best = Infinity;
    // What shell r holds is at least r - 1 cells away.
    for (let r = 0; r <= furthest && best > ((r - 1) * this.size) ** 2; ++r) {
      best = this.searchShell(i, x, y, z, r, best);
    }
    return Math.sqrt(best);
  }

  private cell(i: number, axis: number): number {
    return Math.floor(((this.positions[3 * i + axis] ?? 0) - (this.low[axis] ?? 0)) / this.size);
  }

  private bucket(x: number, y: number, z: number): number {
    const hash = Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791);
    return hash & (this.first.length - 1);
  }

  /** The least squared distance to sample `i` in the cells `r` away from its own, or `best`. */
  private searchShell(i: number, cx: number, cy: number, cz: number, r: number, best: number): number {
    const [nx = 0, ny = 0, nz = 0] = this.cells;
    for (let x = Math.max(0, cx - r); x <= Math.min(nx, cx + r); ++x) {
      for (let y = Math.max(0, cy - r); y <= Math.min(ny, cy + r); ++y) {
        const side = Math.abs(x - cx) === r || Math.abs(y - cy) === r;
        const step = side || r === 0 ? 1 : 2 * r;
        for (let z = cz - r; z <= cz + r; z += step) {
          if (z >= 0 && z <= nz) best = this.searchBucket(i, this.bucket(x, y, z), best);
        }
      }
    }
    return best;
  }

  private searchBucket(i: number, bucket: number, best: number): number {
    const p = this.positions;
    for (let j = this.first[bucket] ?? -1; j >= 0; j = this.next[j] ?? -1) {
      if (j === i) continue;
      const dx = (p[3 * i] ?? 0) - (p[3 * j] ?? 0);
      const dy = (p[3 * i + 1] ?? 0) - (p[3 * j + 1] ?? 0);
      const dz = (p[3 * i + 2] ?? 0) - (p[3 * j + 2] ?? 0);
      const squared = dx * dx + dy * dy + dz * dz;
      if (squared < best) best = squared;
    }
    return best;
  }
}

/** Spacing of a hexagonal lattice of `count` samples on `area`, which distances are held against. */
export function hexagonalSpacing(area: number, count: number): number {
  return Math.sqrt((2 * area) / (Math.sqrt(3) * count));
}
