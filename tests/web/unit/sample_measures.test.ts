import { expect, test } from 'vitest';
import {
  hexagonalSpacing,
  meanAreaAround,
  nearestDistances,
  triangleAreas,
} from '../../../client/web/src/view/sample_measures';
import { torus, TORUS_AREA } from '../support/meshes';

/** Numbers in [0, 1) that look like chance, the same each time. */
function numbers(count: number): Float32Array {
  let state = 1;
  return Float32Array.from({ length: count }, () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  });
}

function searched(positions: Float32Array): number[] {
  const point = (i: number) => positions.subarray(3 * i, 3 * i + 3);
  const count = positions.length / 3;
  return Array.from({ length: count }, (_, i) => {
    let best = Infinity;
    for (let j = 0; j < count; ++j) {
      if (i === j) continue;
      const [p, q] = [point(i), point(j)];
      const squares = [0, 1, 2].map((k) => ((p[k] ?? 0) - (q[k] ?? 0)) ** 2);
      best = Math.min(best, Math.sqrt(squares.reduce((sum, square) => sum + square)));
    }
    return Math.fround(best);
  });
}

test.each([1.0, 1e-3, 0])('NearestDistances.Equal those of a full search, thickness %d', (thickness) => {
  const positions = numbers(900).map((x, i) => (i % 3 === 2 ? thickness * x : x));
  expect([...nearestDistances(positions)]).toEqual(searched(positions));
});

test('NearestDistances.Samples far apart find each other', () => {
  expect([...nearestDistances(Float32Array.of(0, 0, 0, 0, 0, 0, 100, 0, 0))]).toEqual([0, 0, 100]);
});

test('TriangleAreas.Sum to the area of a torus', () => {
  const { positions, faces } = torus(200, 100);
  const areas = triangleAreas(Float32Array.from(positions.flat()), Uint32Array.from(faces.flat()));
  const sum = areas.reduce((total, area) => total + area, 0);
  expect(Math.abs(sum / TORUS_AREA - 1)).toBeLessThan(2e-3);
});

test('MeanAreaAround.Sample without triangles has none', () => {
  const around = meanAreaAround(Float32Array.of(2, 4), Uint32Array.of(0, 1, 2, 0, 2, 3), 5);
  expect([...around]).toEqual([3, 2, 3, 4, NaN]);
});

test('HexagonalSpacing.Lattice of spacing 1 has it', () => {
  // Each point of the lattice owns sqrt(3) / 2.
  expect(hexagonalSpacing(100 * (Math.sqrt(3) / 2), 100)).toBeCloseTo(1, 12);
});
