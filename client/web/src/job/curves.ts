import type { DescMessage, Message } from '@bufbuild/protobuf';

/** A sampled function of one variable. */
export interface Curve {
  /** Field name in the API, for example `radial_mean`. */
  name: string;
  x: number[];
  y: number[];
}

function isCurve(message: DescMessage): boolean {
  return ['x', 'y'].every((name) => message.field[name]?.fieldKind === 'list');
}

/**
 * Every field of `message` that is a message with the lists x and y and is set. A curve that the API
 * learns later is shown without a change here.
 */
export function curvesOf(schema: DescMessage, message: Message): Curve[] {
  const values = message as unknown as Record<string, { x: number[]; y: number[] } | undefined>;
  return schema.fields.flatMap((field) => {
    if (field.fieldKind !== 'message' || !isCurve(field.message)) return [];
    const curve = values[field.localName];
    return curve && curve.x.length > 0 ? [{ name: field.name, x: curve.x, y: curve.y }] : [];
  });
}

const TITLES: Record<string, string> = {
  radial_mean: 'Radial mean',
  anisotropy: 'Anisotropy',
  power_spectrum: 'Power spectrum',
  angle_histogram: 'Angles',
};

/** What a chart of the curve is called. */
export function curveTitle(name: string): string {
  const words = name.replaceAll('_', ' ');
  return TITLES[name] ?? words.charAt(0).toUpperCase() + words.slice(1);
}
