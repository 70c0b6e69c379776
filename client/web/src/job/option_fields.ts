import { TABLE, TABLE_NAMES, type OptionUse, type TableName } from './option_table';

/** One option of a new job, as the form shows it. All options of `ccst sample` that a server knows. */
export interface OptionField {
  name: OptionName;
  label: string;
  help: string;
  kind: 'number' | 'text' | 'choice' | 'switch' | 'image';
  /** value: what people read. */
  choices?: [string, string][];
  placeholder?: string;
  /** Shown only then. */
  when?: (values: OptionValues) => boolean;
}

/** The sampling options, and what belongs to the job alone. */
export type OptionName = TableName | 'displayName' | 'labels' | 'noCache';

/** What the form holds: texts as typed; switches are 'on' or ''. */
export type OptionValues = Record<Exclude<OptionName, 'image'>, string> & { image?: Uint8Array };

/** Choices have their default; what is empty is left to the server. */
export const DEFAULT_VALUES = {
  ...Object.fromEntries(
    TABLE_NAMES.filter((name) => TABLE[name].kind !== 'image').map((name) => {
      const option = TABLE[name];
      return [name, option.kind === 'choice' ? (option.choices[0]?.[0] ?? '') : ''];
    }),
  ),
  count: '5000',
  displayName: '',
  labels: '',
  noCache: '',
} as OptionValues;

const USES: Record<OptionUse, (values: OptionValues) => boolean> = {
  always: () => true,
  relaxing: (v) => ['ccst', 'lloyd', 'ccvt'].includes(v.method),
  ccst: (v) => v.method === 'ccst',
  density: (v) => v.density !== 'uniform',
  curvature: (v) => v.density === 'curvature',
  attribute: (v) => v.density === 'attribute',
  texture: (v) => v.density === 'texture',
};

/** Whether a sampling option makes a difference beside the others. */
export function isInUse(name: TableName, values: OptionValues): boolean {
  return USES[TABLE[name].use](values);
}

function fieldOf(name: TableName): OptionField {
  const option = TABLE[name];
  const { label, kind } = option;
  const field: OptionField = { name, label, kind, help: '', when: (values) => isInUse(name, values) };
  if (option.kind === 'number') {
    return { ...field, placeholder: option.default, help: `${option.help}; ${option.range}.` };
  }
  // A switch says by its label what it does.
  if (kind !== 'switch') field.help = `${option.help}.`;
  return option.kind === 'choice' ? { ...field, choices: option.choices } : field;
}

const titles = [...new Set(TABLE_NAMES.map((name) => TABLE[name].group))];

export const OPTION_GROUPS: { title: string; fields: OptionField[] }[] = [
  ...titles.map((title) => ({
    title,
    fields: TABLE_NAMES.filter((name) => TABLE[name].group === title).map(fieldOf),
  })),
  {
    title: 'In lists',
    fields: [
      { name: 'displayName', label: 'Name', kind: 'text', help: 'What to call the job.' },
      {
        name: 'labels',
        label: 'Labels',
        kind: 'text',
        placeholder: 'project=x stage=final',
        help: 'KEY=VALUE pairs, for filters; at most 16.',
      },
      {
        name: 'noCache',
        label: 'Compute again what the server has computed before',
        kind: 'switch',
        help: '',
      },
    ],
  },
];
