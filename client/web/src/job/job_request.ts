import type { MessageInitShape } from '@bufbuild/protobuf';
import {
  CurvatureDensity_Measure,
  Energy,
  SamplingMethod,
  type SamplingOptionsSchema,
} from '@api/job_pb';
import type { CreateJobRequestSchema } from '@api/sampling_service_pb';
import type { OptionName, OptionValues } from './option_fields';

type OptionsInit = MessageInitShape<typeof SamplingOptionsSchema>;
export type JobRequest = MessageInitShape<typeof CreateJobRequestSchema>;

/** A field that cannot be sent as it is, and what would be right. */
export interface FieldError {
  field: OptionName;
  message: string;
}

export const METHODS: Record<string, SamplingMethod> = {
  ccst: SamplingMethod.CCST,
  white: SamplingMethod.WHITE_NOISE,
  poisson: SamplingMethod.POISSON_DISK,
  elimination: SamplingMethod.SAMPLE_ELIMINATION,
  lloyd: SamplingMethod.LLOYD,
  ccvt: SamplingMethod.CCVT,
};

const MEASURES: Record<string, CurvatureDensity_Measure> = {
  gaussian: CurvatureDensity_Measure.GAUSSIAN,
  mean: CurvatureDensity_Measure.MEAN,
  maximum: CurvatureDensity_Measure.MAXIMUM,
};

// Where the server's own check is the judge, the form only asks for a number.
const WHOLE = /^\d+$/;

/** Reads `KEY=VALUE` pairs apart by blanks or commas. */
export function parseLabels(text: string): Record<string, string> | undefined {
  const labels: Record<string, string> = {};
  for (const pair of text.split(/[\s,]+/).filter((p) => p !== '')) {
    const cut = pair.indexOf('=');
    if (cut < 1) return undefined;
    labels[pair.slice(0, cut)] = pair.slice(cut + 1);
  }
  return Object.keys(labels).length <= 16 ? labels : undefined;
}

class Reader {
  readonly errors: FieldError[] = [];
  constructor(private readonly values: OptionValues) {}

  whole(field: Exclude<OptionName, 'image'>, least: bigint): bigint | undefined {
    const text = this.values[field].trim();
    if (text === '') return undefined;
    if (WHOLE.test(text) && BigInt(text) >= least) return BigInt(text);
    this.fail(field, `a whole number, at least ${least}`);
    return undefined;
  }

  number(field: Exclude<OptionName, 'image'>, what: string, right: (x: number) => boolean) {
    const text = this.values[field].trim();
    if (text === '') return undefined;
    const value = Number(text);
    if (Number.isFinite(value) && right(value)) return value;
    this.fail(field, what);
    return undefined;
  }

  fail(field: OptionName, message: string): void {
    this.errors.push({ field, message });
  }
}

function setDensity(options: OptionsInit, values: OptionValues, reader: Reader): void {
  if (values.density === 'uniform') return;
  const shape: { exponent?: number; maxContrast?: number } = {};
  const exponent = reader.number('exponent', 'a number from 0 to 4', (x) => x >= 0 && x <= 4);
  const contrast = reader.number('contrast', 'a number over 1, at most 1e6', (x) => x > 1 && x <= 1e6);
  if (exponent !== undefined) shape.exponent = exponent;
  if (contrast !== undefined) shape.maxContrast = contrast;
  if (values.density === 'curvature') {
    const measure = MEASURES[values.curvature] ?? CurvatureDensity_Measure.GAUSSIAN;
    options.density = { case: 'curvature', value: { measure, ...shape } };
  } else if (values.density === 'attribute') {
    const attributeName = values.attribute.trim();
    if (attributeName === '') reader.fail('attribute', 'the name of an attribute of the mesh');
    options.density = { case: 'attribute', value: { attributeName, ...shape } };
  } else {
    if (!values.image) reader.fail('image', 'a PNG or JPEG');
    const image = values.image ?? new Uint8Array();
    const brightIsDense = values.brightIsDense === 'on';
    options.density = { case: 'texture', value: { image, brightIsDense, ...shape } };
  }
}

/**
 * What the form says as a request for `mesh`, or every field that is wrong. Fields left empty are left
 * out: the server's defaults hold.
 */
export function jobRequest(
  values: OptionValues,
  mesh: string,
  requestId: string,
): { request: JobRequest } | { errors: FieldError[] } {
  const reader = new Reader(values);
  const ccst = values.method === 'ccst';
  const options: OptionsInit = {
    method: METHODS[values.method] ?? SamplingMethod.CCST,
  };
  const count = reader.whole('count', 4n);
  if (count === undefined && reader.errors.length === 0) reader.fail('count', 'how many samples');
  if (count !== undefined) options.sampleCount = count;
  const seed = reader.whole('seed', 0n);
  if (seed !== undefined) options.seed = seed;
  setDensity(options, values, reader);
  const iterations = reader.whole('maxIterations', 0n);
  if (iterations !== undefined) options.maxIterations = Number(iterations);
  const tolerance = reader.number('tolerance', 'a number over 0', (x) => x > 0);
  if (tolerance !== undefined) options.relativeTolerance = tolerance;
  const limit = reader.number('timeLimit', 'seconds, over 0', (x) => x > 0);
  if (limit !== undefined) {
    const whole = Math.floor(limit);
    options.timeLimit = { seconds: BigInt(whole), nanos: Math.round((limit - whole) * 1e9) };
  }
  const weld = reader.number('weldTolerance', 'a length, 0 or more', (x) => x >= 0);
  if (weld !== undefined) options.weldTolerance = weld;
  const crease = reader.number('creaseAngle', 'degrees over 0, under 180', (x) => x > 0 && x < 180);
  if (ccst && crease !== undefined) options.creaseAngleRadians = (crease * Math.PI) / 180;
  if (ccst && values.energy === 'squared-area') options.energy = Energy.SQUARED_AREA;

  const labels = parseLabels(values.labels);
  if (!labels) reader.fail('labels', 'KEY=VALUE pairs, at most 16, for example project=x');
  if (reader.errors.length > 0) return { errors: reader.errors };
  return {
    request: {
      spec: { mesh, options },
      requestId,
      displayName: values.displayName.trim(),
      labels: labels ?? {},
      skipCacheLookup: values.noCache === 'on',
    },
  };
}
