import { create } from '@bufbuild/protobuf';
import { SamplingOptionsSchema, type SamplingMethod, type SamplingOptions } from '@api/job_pb';
import { getField, optionsOf, setField } from './option_messages';
import { TABLE } from './option_table';

/**
 * The options of a reference job: another method, with all that changes the samples of every method, such
 * as their number, the seed and the density.
 */
export function referenceOptions(options: SamplingOptions, method: SamplingMethod): SamplingOptions {
  const copy = create(SamplingOptionsSchema);
  for (const { name, field } of optionsOf(SamplingOptionsSchema)) {
    const value = getField(options, field);
    const { changesSamples, use } = TABLE[name];
    if (value !== undefined && changesSamples && use === 'always') setField(copy, field, value);
  }
  copy.density = options.density;
  copy.method = method;
  return copy;
}
