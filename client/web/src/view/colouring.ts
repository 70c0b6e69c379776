import type { Samples } from '../job/read_results';
import {
  hexagonalSpacing,
  meanAreaAround,
  nearestDistances,
  triangleAreas,
} from './sample_measures';

/** What colours mean. */
export type ColourBy = 'none' | 'density' | 'capacity' | 'nearest';

export const COLOUR_WORDS: Record<ColourBy, string> = {
  none: 'One colour',
  density: 'Density',
  capacity: 'Triangle capacity',
  nearest: 'Nearest distance',
};

/** Values of samples and of triangles with the range that colours span. */
export interface Colouring {
  samples: Float32Array;
  /** Of each triangle, where that is what is measured. */
  triangles?: Float32Array;
  low: number;
  high: number;
  /** What the numbers are, for the legend. */
  unit: string;
  lowWords: string;
  highWords: string;
}

/** Samples and the triangles over them, and the area that they share. */
export interface SampledSurface {
  samples: Samples;
  triangles: Uint32Array;
  area: number;
}

/**
 * The values that `by` colours; undefined where they cannot be had: capacities need triangles. Areas
 * are those of flat triangles: with a density, its product with them is even, not they themselves.
 */
export function colouring(surface: SampledSurface, by: ColourBy): Colouring | undefined {
  const { samples, triangles, area } = surface;
  if (by === 'none') return undefined;
  if (by === 'nearest') {
    const spacing = hexagonalSpacing(area, samples.count);
    return {
      samples: nearestDistances(samples.positions).map((d) => d / spacing),
      low: 0,
      high: 1,
      unit: 'distance to the nearest sample over the hexagonal spacing',
      lowWords: '0',
      highWords: '1',
    };
  }
  if (by === 'capacity') {
    if (triangles.length === 0) return undefined;
    const areas = triangleAreas(samples.positions, triangles);
    const mean = areas.reduce((sum, a) => sum + a, 0) / areas.length;
    return {
      samples: meanAreaAround(areas, triangles, samples.count).map((a) => a / mean),
      triangles: areas.map((a) => a / mean),
      low: 0.8,
      high: 1.2,
      unit: 'area over the mean, of triangles and around samples',
      lowWords: '0.8',
      highWords: '1.2',
    };
  }
  return {
    samples: localDensity(surface).map((d) => Math.log2(d)),
    low: -2,
    high: 2,
    unit: 'samples an area over the mean',
    lowWords: '¼ ×',
    highWords: '4 ×',
  };
}

function localDensity({ samples, triangles, area }: SampledSurface): Float32Array {
  if (triangles.length > 0) {
    const share = area / (triangles.length / 3);
    const around = meanAreaAround(triangleAreas(samples.positions, triangles), triangles, samples.count);
    return around.map((a) => share / a);
  }
  const spacing = hexagonalSpacing(area, samples.count);
  return nearestDistances(samples.positions).map((d) => (spacing / d) ** 2);
}
