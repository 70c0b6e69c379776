import { AttributeKind } from '@api/sampling_service_pb';
import type { SampleAttribute } from '../job/read_results';
import { placesOf, type Writable } from './write_mesh';

interface Column {
  type: 'double' | 'float' | 'int' | 'uchar';
  name: string;
  value(row: number): number;
}

const BYTES = { double: 8, float: 4, int: 4, uchar: 1 };
const COLOUR_NAMES = ['red', 'green', 'blue', 'alpha'];

function attributeColumns(attribute: SampleAttribute): Column[] {
  const { name, kind, size, values } = attribute;
  return Array.from({ length: size }, (_, k): Column => {
    const raw = (row: number) => values[size * row + k] ?? NaN;
    if (kind === AttributeKind.COLOR) {
      const value = (row: number) => Math.round(255 * Math.min(1, Math.max(0, raw(row))));
      return { type: 'uchar', name: COLOUR_NAMES[k] ?? `${name}_${k}`, value };
    }
    if (kind === AttributeKind.TEXTURE_COORDINATES) return { type: 'float', name: k === 0 ? 's' : 't', value: raw };
    return { type: 'float', name: size === 1 ? name : `${name}_${k}`, value: raw };
  });
}

function columnsOf(content: Writable): Column[] {
  const { samples } = content;
  const places = placesOf(content);
  const from = (type: Column['type'], names: string[], values: ArrayLike<number>): Column[] =>
    names.map((name, k) => ({ type, name, value: (row) => values[names.length * row + k] ?? NaN }));
  return [
    ...from('double', ['x', 'y', 'z'], places),
    ...from('float', ['nx', 'ny', 'nz'], samples.normals),
    ...from('int', ['face'], samples.faces),
    ...from('double', ['bary_u', 'bary_v'], samples.barycentrics),
    ...samples.attributes.flatMap(attributeColumns),
  ];
}

/** Binary PLY with the columns of the command: little endian, a vertex a sample. */
export function writePly(content: Writable): Blob {
  const columns = columnsOf(content);
  const { count } = content.samples;
  const faces = content.triangles ? content.triangles.length / 3 : 0;
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    `element vertex ${count}`,
    ...columns.map((column) => `property ${column.type} ${column.name}`),
    ...(content.triangles ? [`element face ${faces}`, 'property list uchar int vertex_indices'] : []),
    'end_header\n',
  ].join('\n');
  const stride = columns.reduce((sum, column) => sum + BYTES[column.type], 0);
  const view = new DataView(new ArrayBuffer(stride * count + 13 * faces));
  let offset = 0;
  for (let row = 0; row < count; ++row) {
    for (const { type, value } of columns) {
      const number = value(row);
      if (type === 'double') view.setFloat64(offset, number, true);
      else if (type === 'float') view.setFloat32(offset, number, true);
      else if (type === 'int') view.setInt32(offset, number, true);
      else view.setUint8(offset, number);
      offset += BYTES[type];
    }
  }
  for (let face = 0; face < faces; ++face) {
    view.setUint8(offset++, 3);
    for (let k = 0; k < 3; ++k, offset += 4) {
      view.setInt32(offset, content.triangles?.[3 * face + k] ?? 0, true);
    }
  }
  return new Blob([header, view.buffer], { type: 'application/octet-stream' });
}
