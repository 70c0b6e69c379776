import type { DescMessage, Message } from '@bufbuild/protobuf';
import { SamplingOptionsSchema, type Job } from '@api/job_pb';
import { DEFAULT_VALUES, type OptionValues } from './option_fields';
import { DENSITY_SCHEMAS, ENUMS, getField, optionsOf } from './option_messages';
import { TABLE, type TableName, type TableOption } from './option_table';

// More than people type, and fewer than show that degrees were radians on the way.
const SHOWN_DIGITS = 12;

// A field's value as the form shows it; empty where it shows none.
function textOf(name: TableName, option: TableOption, value: unknown): string | undefined {
  switch (option.kind) {
    case 'number': {
      const { times, over } = option;
      if (times === over) return String(value);
      return String(Number(((Number(value) * over) / times).toPrecision(SHOWN_DIGITS)));
    }
    case 'choice':
      return Object.entries(ENUMS[name] ?? {}).find(([, number]) => number === value)?.[0];
    case 'switch':
      return value === true ? 'on' : '';
    case 'text':
      return String(value);
    case 'image':
      return undefined;
  }
}

function take(schema: DescMessage, message: Message, values: OptionValues): void {
  for (const { name, field } of optionsOf(schema)) {
    const value = getField(message, field);
    const text = value === undefined ? undefined : textOf(name, TABLE[name], value);
    if (text !== undefined) Object.assign(values, { [name]: text });
  }
}

/** The options of a job as the form shows them, to run it again with changes. Images are not kept. */
export function valuesOf(job: Job): OptionValues {
  const options = job.effectiveOptions;
  if (!options) return { ...DEFAULT_VALUES };
  const { density } = options;
  const values: OptionValues = {
    ...DEFAULT_VALUES,
    density: density.case ?? 'uniform',
    displayName: job.displayName,
    labels: Object.entries(job.labels)
      .map(([key, value]) => `${key}=${value}`)
      .join(' '),
  };
  take(SamplingOptionsSchema, options, values);
  if (density.case !== undefined) take(DENSITY_SCHEMAS[density.case], density.value, values);
  return values;
}
