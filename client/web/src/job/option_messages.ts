import {
  create,
  isFieldSet,
  ScalarType,
  type DescField,
  type DescMessage,
  type Message,
} from '@bufbuild/protobuf';
import { DurationSchema, type Duration } from '@bufbuild/protobuf/wkt';
import {
  AttributeDensitySchema,
  CurvatureDensity_Measure,
  CurvatureDensitySchema,
  Energy,
  SamplingMethod,
  SamplingOptionsSchema,
  TextureDensitySchema,
} from '@api/job_pb';
import { TABLE, TABLE_NAMES, type TableName } from './option_table';
import { seconds } from './run_history';

/** The messages of the densities, by the value of the option and the name of the field. */
export const DENSITY_SCHEMAS = {
  curvature: CurvatureDensitySchema,
  attribute: AttributeDensitySchema,
  texture: TextureDensitySchema,
} as const;
export type DensityCase = keyof typeof DENSITY_SCHEMAS;

/** The values of the choices that are fields of a message; the density is which of its messages is set. */
export const ENUMS: Partial<Record<TableName, Record<string, number>>> = {
  method: {
    ccst: SamplingMethod.CCST,
    white: SamplingMethod.WHITE_NOISE,
    poisson: SamplingMethod.POISSON_DISK,
    elimination: SamplingMethod.SAMPLE_ELIMINATION,
    lloyd: SamplingMethod.LLOYD,
    ccvt: SamplingMethod.CCVT,
  },
  energy: { target: Energy.TARGET, 'squared-area': Energy.SQUARED_AREA },
  curvature: {
    gaussian: CurvatureDensity_Measure.GAUSSIAN,
    mean: CurvatureDensity_Measure.MEAN,
    maximum: CurvatureDensity_Measure.MAXIMUM,
  },
};

/** The options whose fields `schema`, of the options or of a density, has. */
export function optionsOf(schema: DescMessage): { name: TableName; field: DescField }[] {
  const inDensity = schema !== (SamplingOptionsSchema as DescMessage);
  return TABLE_NAMES.filter((name) => TABLE[name].inDensity === inDensity).flatMap((name) => {
    const field = schema.fields.find((f) => f.localName === TABLE[name].field);
    return field ? [{ name, field }] : [];
  });
}

/** Whether a whole number is one of the field's type. */
export function fitsField(field: DescField, value: bigint): boolean {
  if (field.scalar === ScalarType.INT32) return BigInt.asIntN(32, value) === value;
  if (field.scalar === ScalarType.UINT64) return BigInt.asUintN(64, value) === value;
  return BigInt.asIntN(64, value) === value;
}

function isDuration(field: DescField): boolean {
  return field.message?.typeName === DurationSchema.typeName;
}

function durationOf(value: number): Duration {
  const whole = Math.floor(value);
  return create(DurationSchema, { seconds: BigInt(whole), nanos: Math.round((value - whole) * 1e9) });
}

/** Sets a field of `message` to a number in the API's units. */
export function setNumber(message: Message, field: DescField, value: number | bigint): void {
  if (isDuration(field)) setField(message, field, durationOf(Number(value)));
  else setField(message, field, field.scalar === ScalarType.INT32 ? Number(value) : value);
}

/** Sets a field of `message` to a value of its type. */
export function setField(message: Message, field: DescField, value: unknown): void {
  Object.assign(message, { [field.localName]: value });
}

/** A field of `message`, durations in seconds; undefined where it is unset. */
export function getField(message: Message, field: DescField): unknown {
  if (!isFieldSet(message, field)) return undefined;
  const value = (message as unknown as Record<string, unknown>)[field.localName];
  return isDuration(field) ? seconds(value as Duration) : value;
}
