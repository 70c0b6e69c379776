import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';
import { CurvatureDensity_Measure, Energy, JobSchema, SamplingMethod } from '@api/job_pb';
import { CreateJobRequestSchema } from '@api/sampling_service_pb';
import { jobRequest, parseLabels } from '../../../client/web/src/job/job_request';
import { DEFAULT_VALUES, type OptionValues } from '../../../client/web/src/job/option_fields';
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
