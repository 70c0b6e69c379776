import type { DescMessage, Message } from '@bufbuild/protobuf';

/** A sampled function of one variable. */
export interface Curve {
  /** Field name in the API, for example `radial_mean`. */
  name: string;
  x: number[];
  y: number[];
}

/** How a curve is shown. */
interface Words {
  title: string;
  /** What x is. */
  axis: string;
  /** Units of the axis in one of the API; 1 where they are the same. */
  perUnit: number;
}

const WORDS: Record<string, Words> = {
  radial_mean: { title: 'Radial mean', axis: 'Distance', perUnit: 1 },
  anisotropy: { title: 'Anisotropy', axis: 'Distance', perUnit: 1 },
  power_spectrum: { title: 'Power spectrum', axis: 'Frequency', perUnit: 1 },
  angle_histogram: { title: 'Angles', axis: 'Degrees', perUnit: 180 / Math.PI },
};

function isCurve(message: DescMessage): boolean {
  return ['x', 'y'].every((name) => message.field[name]?.fieldKind === 'list');
}

/** Nearly the same number without the digits that rounding left. */
const tidy = (value: number) => Number(value.toPrecision(12));

/**
 * Every field of `message` that is a message with the lists x and y and is set, in the units of its
 * axis. A curve that the API learns later is shown without a change here.
 */
export function curvesOf(schema: DescMessage, message: Message): Curve[] {
  const values = message as unknown as Record<string, { x: number[]; y: number[] } | undefined>;
  return schema.fields.flatMap((field) => {
    if (field.fieldKind !== 'message' || !isCurve(field.message)) return [];
    const curve = values[field.localName];
    if (!curve || curve.x.length === 0) return [];
    const { perUnit } = curveWords(field.name);
    return [{ name: field.name, x: curve.x.map((x) => tidy(perUnit * x)), y: curve.y }];
  });
}

/** What the chart of a curve says. */
export function curveWords(name: string): Words {
  const words = name.replaceAll('_', ' ');
  return WORDS[name] ?? { title: words.charAt(0).toUpperCase() + words.slice(1), axis: 'x', perUnit: 1 };
}
