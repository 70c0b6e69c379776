import { create, fromBinary, toBinary } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';
import {
  CurvatureDensity_Measure,
  Energy,
  JobSchema,
  SamplingMethod,
  SamplingOptionsSchema,
} from '@api/job_pb';
import { CreateJobRequestSchema } from '@api/sampling_service_pb';
import { jobRequest, parseLabels } from '../../../client/web/src/job/job_request';
import {
  DEFAULT_VALUES,
  OPTION_GROUPS,
  type OptionValues,
} from '../../../client/web/src/job/option_fields';
import { DENSITY_SCHEMAS, ENUMS } from '../../../client/web/src/job/option_messages';
import { TABLE, TABLE_NAMES } from '../../../client/web/src/job/option_table';
import { referenceOptions } from '../../../client/web/src/job/reference_options';
import { valuesOf } from '../../../client/web/src/job/values_of_job';

function build(values: Partial<OptionValues>) {
  const built = jobRequest({ ...DEFAULT_VALUES, ...values }, 'meshes/a', 'id');
  return 'errors' in built ? built : { request: create(CreateJobRequestSchema, built.request) };
}

function optionsOf(values: Partial<OptionValues>) {
  const built = build(values);
  if ('errors' in built) throw new Error(JSON.stringify(built.errors));
  return built.request.spec?.options;
}

test('JobRequest.Empty fields are left to the server', () => {
  const options = optionsOf({});
  expect(options?.sampleCount).toBe(5000n);
  expect(options?.seed).toBeUndefined();
  expect(options?.maxIterations).toBeUndefined();
  expect(options?.relativeTolerance).toBeUndefined();
  expect(options?.timeLimit).toBeUndefined();
  expect(options?.creaseAngleRadians).toBeUndefined();
  expect(options?.density.case).toBeUndefined();
});

test('JobRequest.Every option arrives', () => {
  const options = optionsOf({
    count: '42',
    // More than a double holds.
    seed: '18446744073709551615',
    density: 'curvature',
    curvature: 'maximum',
    exponent: '2',
    contrast: '50',
    creaseAngle: '90',
    energy: 'squared-area',
    maxIterations: '0',
    tolerance: '1e-3',
    timeLimit: '1.5',
    weldTolerance: '0.25',
  });
  expect(options).toMatchObject({
    sampleCount: 42n,
    seed: 18446744073709551615n,
    creaseAngleRadians: Math.PI / 2,
    energy: Energy.SQUARED_AREA,
    maxIterations: 0,
    relativeTolerance: 1e-3,
    timeLimit: { seconds: 1n, nanos: 500_000_000 },
    weldTolerance: 0.25,
    density: {
      case: 'curvature',
      value: { measure: CurvatureDensity_Measure.MAXIMUM, exponent: 2, maxContrast: 50 },
    },
  });
});

const NUMBERS = TABLE_NAMES.flatMap((name) => {
  const option = TABLE[name];
  return option.kind === 'number' ? [{ name, option }] : [];
});

// In their ranges, and none a default.
const numbers = Object.fromEntries(
  NUMBERS.map(({ name, option }) => [name, String((option.least ?? 0) + 3)]),
);

test('JobRequest.Every number of the table arrives and comes back', () => {
  const values = { ...numbers, density: 'curvature' };
  const options = optionsOf(values);
  if (!options) throw new Error('no options');
  // Refuses values that are not of a field's type.
  const sent = fromBinary(SamplingOptionsSchema, toBinary(SamplingOptionsSchema, options));
  const job = create(JobSchema, { effectiveOptions: sent });
  expect(valuesOf(job)).toEqual({ ...DEFAULT_VALUES, ...values });
});

test('JobRequest.Numbers at the ends of their ranges are taken as the table says', () => {
  for (const { name, option } of NUMBERS) {
    for (const [end, has] of [[option.least, option.hasLeast], [option.most, option.hasMost]] as const) {
      if (end === undefined) continue;
      const built = build({ density: 'curvature', [name]: String(end) });
      const wrong = 'errors' in built ? built.errors.map((e) => e.field) : [];
      expect(wrong, `${name} ${end}`).toEqual(has ? [] : [name]);
    }
    const built = build({ density: 'curvature', [name]: String((option.least ?? 0) - 1) });
    const message = 'errors' in built ? built.errors[0]?.message : undefined;
    expect(message, name).toContain(option.range);
  }
});

test('JobRequest.Whole numbers that no field holds are refused', () => {
  for (const [field, text] of [['seed', '18446744073709551616'], ['maxIterations', '2147483648']]) {
    const built = build({ [field as string]: text });
    expect('errors' in built && built.errors.map((e) => e.field)).toEqual([field]);
  }
});

test('JobRequest.Every choice of the table is a value of the API', () => {
  for (const name of TABLE_NAMES) {
    const option = TABLE[name];
    if (option.kind !== 'choice') continue;
    const known = name === 'density' ? ['uniform', ...Object.keys(DENSITY_SCHEMAS)] : Object.keys(ENUMS[name] ?? {});
    expect(known.sort(), name).toEqual(option.choices.map(([value]) => value).sort());
  }
});

test('JobRequest.Fields that make no difference are not judged', () => {
  const built = build({ method: 'white', creaseAngle: '500', exponent: '9' });
  expect('errors' in built).toBe(false);
});

test('OptionGroups.Form has every option of the table with its range', () => {
  const fields = OPTION_GROUPS.flatMap((group) => group.fields);
  expect(fields.map((f) => f.name)).toEqual(expect.arrayContaining(TABLE_NAMES));
  expect(fields.find((f) => f.name === 'creaseAngle')?.help).toContain('in (0, 180) degrees');
  expect(fields.find((f) => f.name === 'exponent')?.placeholder).toBe('1');
});

test('ReferenceOptions.Have what changes the samples of every method', () => {
  const options = optionsOf({ ...numbers, density: 'curvature', energy: 'squared-area' });
  if (!options) throw new Error('no options');
  const reference = referenceOptions(options, SamplingMethod.WHITE_NOISE);
  expect(reference).toMatchObject({
    sampleCount: options.sampleCount,
    seed: options.seed,
    weldTolerance: options.weldTolerance,
    density: options.density,
    method: SamplingMethod.WHITE_NOISE,
  });
  expect(reference.energy).toBe(Energy.UNSPECIFIED);
  expect(reference.creaseAngleRadians).toBeUndefined();
  expect(reference.maxIterations).toBeUndefined();
  expect(reference.timeLimit).toBeUndefined();
});

test('JobRequest.Methods other than CCST send none of its options', () => {
  const options = optionsOf({ method: 'white', creaseAngle: '30', energy: 'squared-area' });
  expect(options?.method).toBe(SamplingMethod.WHITE_NOISE);
  expect(options?.creaseAngleRadians).toBeUndefined();
  expect(options?.energy).toBe(Energy.UNSPECIFIED);
});

test('JobRequest.All wrong fields are named at once', () => {
  const built = build({ count: '3', seed: '-1', tolerance: '0', labels: 'project' });
  expect('errors' in built && built.errors.map((e) => e.field).sort()).toEqual(
    ['count', 'labels', 'seed', 'tolerance'],
  );
});

test('JobRequest.Texture density without an image is refused', () => {
  const built = build({ density: 'texture' });
  expect('errors' in built && built.errors[0]?.field).toBe('image');
});

test('Labels.Pairs are split by blanks and commas', () => {
  expect(parseLabels(' a=1, b=x=y ')).toEqual({ a: '1', b: 'x=y' });
  expect(parseLabels('')).toEqual({});
  expect(parseLabels('=1')).toBeUndefined();
});

test('ValuesOfJob.Form of a job asks for the same job', () => {
  const values: Partial<OptionValues> = {
    count: '800',
    seed: '3',
    density: 'attribute',
    attribute: 'heat',
    exponent: '2',
    contrast: '10',
    creaseAngle: '40',
    maxIterations: '12',
    tolerance: '0.5',
    timeLimit: '60',
    displayName: 'x',
    labels: 'a=1 b=2',
  };
  const built = build(values);
  if ('errors' in built) throw new Error();
  const { spec, displayName, labels } = built.request;
  if (!spec?.options) throw new Error('no options');
  const job = create(JobSchema, { effectiveOptions: spec.options, displayName, labels });
  expect(valuesOf(job)).toEqual({ ...DEFAULT_VALUES, ...values });
});
