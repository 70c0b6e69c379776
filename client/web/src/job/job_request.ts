import { create, type DescMessage, type Message, type MessageInitShape } from '@bufbuild/protobuf';
import { SamplingOptionsSchema, type SamplingOptions } from '@api/job_pb';
import type { CreateJobRequestSchema } from '@api/sampling_service_pb';
import { isInUse, type OptionName, type OptionValues } from './option_fields';
import {
  DENSITY_SCHEMAS,
  ENUMS,
  fitsField,
  optionsOf,
  setField,
  setNumber,
  type DensityCase,
} from './option_messages';
import { isInRange, TABLE, type NumberOption, type TableName } from './option_table';

export type JobRequest = MessageInitShape<typeof CreateJobRequestSchema>;

/** A field that cannot be sent as it is, and what would be right. */
export interface FieldError {
  field: OptionName;
  message: string;
}

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

// Reads the form into messages. What is empty, or makes no difference beside the rest, is left out.
class Reader {
  readonly errors: FieldError[] = [];
  constructor(private readonly values: OptionValues) {}

  /** Sets the fields of `message` that the form has. */
  read(schema: DescMessage, message: Message): void {
    for (const { name, field } of optionsOf(schema)) {
      if (!isInUse(name, this.values)) continue;
      const option = TABLE[name];
      if (option.kind === 'image') {
        if (!this.values.image) this.fail(name, 'a PNG or JPEG');
        setField(message, field, this.values.image ?? new Uint8Array());
        continue;
      }
      const text = this.values[name as Exclude<TableName, 'image'>].trim();
      if (option.kind === 'number') {
        const value = this.number(name, option, text);
        if (value === undefined) continue;
        if (typeof value === 'number' || fitsField(field, value)) setNumber(message, field, value);
        else this.fail(name, 'a smaller number');
      } else if (option.kind === 'choice') {
        setField(message, field, ENUMS[name]?.[text] ?? 0);
      } else if (option.kind === 'switch') {
        setField(message, field, text === 'on');
      } else {
        if (text === '') this.fail(name, `the ${option.label.toLowerCase()}`);
        setField(message, field, text);
      }
    }
  }

  fail(field: OptionName, message: string): void {
    this.errors.push({ field, message });
  }

  // In the units of the API.
  private number(name: TableName, option: NumberOption, text: string): number | bigint | undefined {
    if (text === '') return undefined;
    const value = Number(text);
    if ((!option.whole || WHOLE.test(text)) && Number.isFinite(value) && isInRange(option, value)) {
      return option.whole ? BigInt(text) : (value * option.times) / option.over;
    }
    this.fail(name, `a ${option.whole ? 'whole number' : 'number'} that is ${option.range}`);
    return undefined;
  }
}

function readDensity(options: SamplingOptions, values: OptionValues, reader: Reader): void {
  if (values.density === 'uniform') return;
  const kind = values.density as DensityCase;
  const value = create(DENSITY_SCHEMAS[kind] as DescMessage);
  reader.read(DENSITY_SCHEMAS[kind], value);
  options.density = { case: kind, value } as SamplingOptions['density'];
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
  const options = create(SamplingOptionsSchema);
  if (values.count.trim() === '') reader.fail('count', 'how many samples');
  reader.read(SamplingOptionsSchema, options);
  readDensity(options, values, reader);

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
