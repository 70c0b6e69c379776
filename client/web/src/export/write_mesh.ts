import type { Samples } from '../job/read_results';

/** What is written: samples, and for a mesh its triangles, M x 3. */
export interface Writable {
  samples: Samples;
  triangles?: Uint32Array;
  /** Added to every position, in doubles. */
  origin: [number, number, number];
}

/** The place of each sample in doubles, N x 3. */
export function placesOf({ samples, origin }: Writable): Float64Array {
  return Float64Array.from(samples.positions, (p, i) => p + (origin[i % 3] ?? 0));
}

/** OBJ text; samples without triangles become points (`p`). */
export function writeObj(content: Writable): Blob {
  const places = placesOf(content);
  const lines: string[] = [];
  for (let i = 0; i < places.length; i += 3) {
    lines.push(`v ${places[i]} ${places[i + 1]} ${places[i + 2]}`);
  }
  const { normals } = content.samples;
  for (let i = 0; i < normals.length; i += 3) {
    lines.push(`vn ${normals[i]} ${normals[i + 1]} ${normals[i + 2]}`);
  }
  const corner = (index: number | undefined) => `${(index ?? 0) + 1}//${(index ?? 0) + 1}`;
  const { triangles } = content;
  if (triangles) {
    for (let t = 0; t < triangles.length; t += 3) {
      lines.push(`f ${corner(triangles[t])} ${corner(triangles[t + 1])} ${corner(triangles[t + 2])}`);
    }
  } else {
    for (let i = 1; i <= content.samples.count; ++i) lines.push(`p ${i}`);
  }
  return new Blob([lines.join('\n'), '\n'], { type: 'model/obj' });
}

/** Text of comma-separated values with the columns of the command. */
export function writeCsv(content: Writable): Blob {
  const { samples } = content;
  const places = placesOf(content);
  const names = samples.attributes.flatMap((a) =>
    a.size === 1 ? [a.name] : Array.from({ length: a.size }, (_, k) => `${a.name}_${k}`),
  );
  const rows = [['x,y,z,nx,ny,nz,face,bary_u,bary_v', ...names].join(',')];
  for (let i = 0; i < samples.count; ++i) {
    rows.push(
      [
        ...places.subarray(3 * i, 3 * i + 3),
        ...samples.normals.subarray(3 * i, 3 * i + 3),
        samples.faces[i],
        ...samples.barycentrics.subarray(2 * i, 2 * i + 2),
        ...samples.attributes.flatMap((a) => [...a.values.subarray(a.size * i, a.size * (i + 1))]),
      ].join(','),
    );
  }
  return new Blob([rows.join('\n'), '\n'], { type: 'text/csv' });
}
