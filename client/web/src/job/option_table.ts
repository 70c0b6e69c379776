import table from './options.json';

/** When an option makes a difference. */
export type OptionUse =
  | 'always'
  | 'relaxing'
  | 'ccst'
  | 'density'
  | 'curvature'
  | 'attribute'
  | 'texture';

interface OptionBase {
  /** Its name in the API's messages, as the code made from the protos has it. */
  field: string;
  label: string;
  /** A sentence without its full stop. */
  help: string;
  /** The title it stands under. */
  group: string;
  use: OptionUse;
  /** Whether it is a field of the densities' messages. */
  inDensity: boolean;
  changesSamples: boolean;
}

/** Bounds are in the user's units; the API's are value * times / over. */
export interface NumberOption extends OptionBase {
  kind: 'number';
  whole: boolean;
  least?: number;
  most?: number;
  hasLeast: boolean;
  hasMost: boolean;
  /** To follow "a number that is". */
  range: string;
  times: number;
  over: number;
  default: string;
}

export interface ChoiceOption extends OptionBase {
  kind: 'choice';
  /** The value, which the command line has too, and what people read; the first is the default. */
  choices: [string, string][];
}

export interface OtherOption extends OptionBase {
  kind: 'switch' | 'text' | 'image';
}

export type TableOption = NumberOption | ChoiceOption | OtherOption;
export type TableName = keyof typeof table;

/**
 * The options that the API takes, in the order of the form. options.json is written from
 * core/sampling/option_table.h; a test compares the two and says how.
 */
export const TABLE = table as unknown as Record<TableName, TableOption>;
export const TABLE_NAMES = Object.keys(table) as TableName[];

/** Whether `value`, in the user's units, is in the range of `option`. */
export function isInRange(option: NumberOption, value: number): boolean {
  const { least = -Infinity, most = Infinity, hasLeast, hasMost } = option;
  return (hasLeast ? value >= least : value > least) && (hasMost ? value <= most : value < most);
}
