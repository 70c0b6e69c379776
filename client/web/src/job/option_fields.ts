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

export type OptionName =
  | 'count'
  | 'seed'
  | 'method'
  | 'density'
  | 'attribute'
  | 'image'
  | 'brightIsDense'
  | 'curvature'
  | 'exponent'
  | 'contrast'
  | 'creaseAngle'
  | 'energy'
  | 'maxIterations'
  | 'tolerance'
  | 'timeLimit'
  | 'weldTolerance'
  | 'displayName'
  | 'labels'
  | 'noCache';

/** What the form holds: texts as typed; switches are 'on' or ''. */
export type OptionValues = Record<Exclude<OptionName, 'image'>, string> & { image?: Uint8Array };

export const DEFAULT_VALUES: OptionValues = {
  count: '5000',
  seed: '',
  method: 'ccst',
  density: 'uniform',
  attribute: '',
  brightIsDense: '',
  curvature: 'gaussian',
  exponent: '',
  contrast: '',
  creaseAngle: '',
  energy: 'target',
  maxIterations: '',
  tolerance: '',
  timeLimit: '',
  weldTolerance: '',
  displayName: '',
  labels: '',
  noCache: '',
};

const relaxes = (v: OptionValues) => ['ccst', 'lloyd', 'ccvt'].includes(v.method);

export const OPTION_GROUPS: { title: string; fields: OptionField[] }[] = [
  {
    title: 'Samples',
    fields: [
      { name: 'count', label: 'Count', kind: 'number', help: 'You get exactly as many.' },
      {
        name: 'method',
        label: 'Method',
        kind: 'choice',
        help: 'CCST gives even samples and a mesh over them; the others are there to compare with.',
        choices: [
          ['ccst', 'CCST'],
          ['elimination', 'Sample elimination (Poisson disk)'],
          ['poisson', 'Dart throwing (Poisson disk)'],
          ['lloyd', 'Lloyd relaxation'],
          ['ccvt', 'CCVT, at most 20,000'],
          ['white', 'White noise'],
        ],
      },
      {
        name: 'seed',
        label: 'Seed',
        kind: 'number',
        placeholder: '0',
        help: 'Another seed gives other, equally good samples.',
      },
    ],
  },
  {
    title: 'Density',
    fields: [
      {
        name: 'density',
        label: 'Where more samples belong',
        kind: 'choice',
        help: 'Where the density is twice as high there are twice as many samples.',
        choices: [
          ['uniform', 'Uniform'],
          ['curvature', 'Where the surface bends'],
          ['attribute', 'An attribute of the mesh'],
          ['texture', 'An image over its texture coordinates'],
        ],
      },
      {
        name: 'curvature',
        label: 'Curvature',
        kind: 'choice',
        help: 'What is measured.',
        choices: [
          ['gaussian', 'Gaussian'],
          ['mean', 'Mean'],
          ['maximum', 'Maximum'],
        ],
        when: (v) => v.density === 'curvature',
      },
      {
        name: 'attribute',
        label: 'Attribute',
        kind: 'text',
        help: 'Name of a number that the mesh carries at its vertices; a PLY property, for example.',
        when: (v) => v.density === 'attribute',
      },
      {
        name: 'image',
        label: 'Image',
        kind: 'image',
        help: 'PNG or JPEG. Dark places get more samples.',
        when: (v) => v.density === 'texture',
      },
      {
        name: 'brightIsDense',
        label: 'Bright places get more samples instead',
        kind: 'switch',
        help: '',
        when: (v) => v.density === 'texture',
      },
      {
        name: 'exponent',
        label: 'Exponent',
        kind: 'number',
        placeholder: '1',
        help: 'Power of the source that the density is, 0 to 4.',
        when: (v) => v.density !== 'uniform',
      },
      {
        name: 'contrast',
        label: 'Contrast',
        kind: 'number',
        placeholder: '100',
        help: 'Largest density over smallest; smaller ones are raised.',
        when: (v) => v.density !== 'uniform',
      },
    ],
  },
  {
    title: 'Surface',
    fields: [
      {
        name: 'creaseAngle',
        label: 'Crease angle (degrees)',
        kind: 'number',
        placeholder: 'off',
        help: 'Keeps samples on edges at which the faces turn by more than this.',
        when: (v) => v.method === 'ccst',
      },
      {
        name: 'weldTolerance',
        label: 'Weld tolerance',
        kind: 'number',
        placeholder: '0',
        help: 'Joins vertices at most this far apart first, in units of the mesh.',
      },
    ],
  },
  {
    title: 'When to stop',
    fields: [
      {
        name: 'maxIterations',
        label: 'Most alternations',
        kind: 'number',
        placeholder: '130',
        help: 'By default 130; of Lloyd 100, of CCVT 1000. 0 gives the initial set.',
        when: relaxes,
      },
      {
        name: 'tolerance',
        label: 'Tolerance',
        kind: 'number',
        placeholder: '0.12',
        help: "Stops when the capacities' variation improves by less than this share.",
        when: relaxes,
      },
      {
        name: 'timeLimit',
        label: 'Time limit (seconds)',
        kind: 'number',
        placeholder: 'none',
        help: 'Returns what it has by then; the samples then depend on the machine.',
      },
      {
        name: 'energy',
        label: 'Energy',
        kind: 'choice',
        help: 'What is minimised. Squared area is what the paper prints, to compare with.',
        choices: [
          ['target', 'Target: variance about equal shares'],
          ['squared-area', 'Squared area'],
        ],
        when: (v) => v.method === 'ccst',
      },
    ],
  },
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
