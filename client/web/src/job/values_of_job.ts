import { CurvatureDensity_Measure, Energy, type Job } from '@api/job_pb';
import { METHODS } from './job_request';
import { DEFAULT_VALUES, type OptionValues } from './option_fields';
import { seconds } from './run_history';

const text = (value: number | bigint | undefined) => (value === undefined ? '' : String(value));

/** The options of a job as the form shows them, to run it again with changes. Images are not kept. */
export function valuesOf(job: Job): OptionValues {
  const options = job.effectiveOptions;
  if (!options) return { ...DEFAULT_VALUES };
  const { density } = options;
  const values: OptionValues = {
    ...DEFAULT_VALUES,
    count: text(options.sampleCount),
    seed: text(options.seed),
    method: Object.keys(METHODS).find((name) => METHODS[name] === options.method) ?? 'ccst',
    density: density.case ?? 'uniform',
    energy: options.energy === Energy.SQUARED_AREA ? 'squared-area' : 'target',
    maxIterations: text(options.maxIterations),
    tolerance: text(options.relativeTolerance),
    timeLimit: text(seconds(options.timeLimit)),
    weldTolerance: options.weldTolerance > 0 ? text(options.weldTolerance) : '',
    displayName: job.displayName,
    labels: Object.entries(job.labels)
      .map(([key, value]) => `${key}=${value}`)
      .join(' '),
  };
  if (options.creaseAngleRadians !== undefined) {
    values.creaseAngle = Number(((options.creaseAngleRadians * 180) / Math.PI).toPrecision(6)).toString();
  }
  if (density.case === undefined) return values;
  values.exponent = text(density.value.exponent);
  values.contrast = text(density.value.maxContrast);
  if (density.case === 'attribute') values.attribute = density.value.attributeName;
  if (density.case === 'texture') values.brightIsDense = density.value.brightIsDense ? 'on' : '';
  if (density.case === 'curvature') {
    const name = CurvatureDensity_Measure[density.value.measure]?.toLowerCase() ?? '';
    values.curvature = ['mean', 'maximum'].includes(name) ? name : 'gaussian';
  }
  return values;
}
