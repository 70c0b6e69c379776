import type { AnalyzeJobResponse } from '@api/sampling_service_pb';
import { figure } from './words';

/** One row of the quality report. */
export interface QualityFigure {
  label: string;
  help: string;
  value(report: AnalyzeJobResponse): number | undefined;
  words(value: number): string;
  /** Whether larger is better. */
  better: 'larger' | 'smaller';
}

const degrees = (radians: number | undefined) =>
  radians === undefined ? undefined : (radians * 180) / Math.PI;

/** What AnalyzeJob measures, in the order of the report. */
export const QUALITY_FIGURES: QualityFigure[] = [
  {
    label: 'Smallest distance',
    help: 'Between two samples on one side of the surface, over the hexagonal spacing. White noise has nearly 0, good blue noise 0.65 and more.',
    value: (r) => r.relativeRadiusSameSide,
    words: figure,
    better: 'larger',
  },
  {
    label: 'Mean nearest distance',
    help: 'Over the hexagonal spacing; a perfect lattice has 1.',
    value: (r) => r.meanNearestDistance,
    words: figure,
    better: 'larger',
  },
  {
    label: 'Variation of capacities',
    help: 'Standard deviation over mean of the triangles’ shares of the surface; 0 is perfect.',
    value: (r) => r.capacityCv,
    words: (v) => `${(100 * v).toFixed(2)} %`,
    better: 'smaller',
  },
  {
    label: 'Smallest angle',
    help: 'Of all triangles over the samples; 60° is the most there can be.',
    value: (r) => degrees(r.minAngleRadians),
    words: (v) => `${v.toFixed(1)}°`,
    better: 'larger',
  },
  {
    label: 'Mean smallest angle',
    help: 'Mean over the triangles of their smallest angle.',
    value: (r) => degrees(r.meanMinAngleRadians),
    words: (v) => `${v.toFixed(1)}°`,
    better: 'larger',
  },
  {
    label: '5 to 7 neighbours',
    help: 'Share of the samples off the boundary with 5 to 7 neighbours.',
    value: (r) => r.valence57Share,
    words: (v) => `${(100 * v).toFixed(2)} %`,
    better: 'larger',
  },
];
