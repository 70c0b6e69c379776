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
 * Distance of each sample to its nearest other one, N; Infinity for a single one. Cells of about one
 * sample each are searched in shells, which costs O(N) for samples on surfaces.
 */
export function nearestDistances(positions: Float32Array): Float32Array {
  const count = positions.length / 3;
  const at = (i: number, axis: number) => positions[3 * i + axis] ?? 0;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k] ?? 0, at(i, k));
      high[k] = Math.max(high[k] ?? 0, at(i, k));
    }
  }
  const extents = low.map((l, k) => (high[k] ?? 0) - l);
  // A surface fills about as many cells of this size as it has samples.
  const size = Math.max(...extents, Number.MIN_VALUE) / Math.max(1, Math.sqrt(count));
  const cells = extents.map((extent) => Math.floor(extent / size) + 1);
  const cellOf = (i: number, k: number) => Math.floor((at(i, k) - (low[k] ?? 0)) / size);
  const key = (x: number, y: number, z: number) => (x * (cells[1] ?? 1) + y) * (cells[2] ?? 1) + z;

  const first = new Map<number, number>();
  const next = new Int32Array(count).fill(-1);
  for (let i = 0; i < count; ++i) {
    const cell = key(cellOf(i, 0), cellOf(i, 1), cellOf(i, 2));
    next[i] = first.get(cell) ?? -1;
    first.set(cell, i);
  }
  const searchShell = (i: number, radius: number, best: number): number => {
    const [cx, cy, cz] = [cellOf(i, 0), cellOf(i, 1), cellOf(i, 2)];
    for (let x = cx - radius; x <= cx + radius; ++x) {
      for (let y = cy - radius; y <= cy + radius; ++y) {
        const side = Math.max(Math.abs(x - cx), Math.abs(y - cy)) === radius;
        const step = side || radius === 0 ? 1 : 2 * radius;
        for (let z = cz - radius; z <= cz + radius; z += step) {
          if (x < 0 || y < 0 || z < 0) continue;
          if (x >= (cells[0] ?? 1) || y >= (cells[1] ?? 1) || z >= (cells[2] ?? 1)) continue;
          for (let j = first.get(key(x, y, z)) ?? -1; j >= 0; j = next[j] ?? -1) {
            if (j === i) continue;
            best = Math.min(best, Math.hypot(at(i, 0) - at(j, 0), at(i, 1) - at(j, 1), at(i, 2) - at(j, 2)));
          }
        }
      }
    }
    return best;
  };
  const furthest = Math.max(...cells);
  const distances = new Float32Array(count);
  for (let i = 0; i < count; ++i) {
    let best = Infinity;
    // What shell r holds is at least r - 1 cells away.
    for (let r = 0; r <= furthest && best > (r - 1) * size; ++r) best = searchShell(i, r, best);
    distances[i] = best;
  }
  return distances;
}

/** Spacing of a hexagonal lattice of `count` samples on `area`, which distances are held against. */
export function hexagonalSpacing(area: number, count: number): number {
  return Math.sqrt((2 * area) / (Math.sqrt(3) * count));
}
