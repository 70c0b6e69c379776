import { createDecoderModule, createEncoderModule } from 'draco3d';
import { expect, test } from 'vitest';
import { decodeDraco, encodeDraco } from '../../../client/web/src/mesh/draco';
import { plyScalars, readMesh } from '../../../client/web/src/mesh/read_mesh';
import { withoutUnusedVertices } from '../../../client/web/src/mesh/surface_checks';
import { MeshFileError } from '../../../client/web/src/mesh/surface_mesh';
import { asObj, asOff, torus } from '../support/meshes';

const bytes = (text: string) => new TextEncoder().encode(text);
const mesh = torus(12, 8);

/** Where the corners of the triangles are, whatever the numbering of vertices. */
function corners({ positions, indices }: { positions: Float32Array; indices: Uint32Array }): number[] {
  return [...indices].flatMap((i) => [...positions.subarray(3 * i, 3 * i + 3)]);
}
const expected = [...Float32Array.from(mesh.faces.flat().flatMap((i) => mesh.positions[i] ?? []))];

test('ReadMesh.Faces of an OFF file keep their order and places', async () => {
  expect(corners(await readMesh('torus.off', bytes(asOff(mesh))))).toEqual(expected);
});

test('ReadMesh.Faces of an OBJ file keep their order and places', async () => {
  expect(corners(await readMesh('torus.OBJ', bytes(asObj(mesh))))).toEqual(expected);
});

test('ReadMesh.Triangles of an STL file keep their places', async () => {
  const facets = mesh.faces.map(
    (face) =>
      `facet normal 0 0 0\nouter loop\n${face.map((i) => `vertex ${mesh.positions[i]?.join(' ')}\n`).join('')}endloop\nendfacet\n`,
  );
  const text = `solid torus\n${facets.join('')}endsolid torus\n`;
  expect(corners(await readMesh('torus.stl', bytes(text)))).toEqual(expected);
});

test('ReadMesh.Polygons of an OFF file become fans', async () => {
  const text = 'OFF # a square\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n';
  expect([...(await readMesh('a.off', bytes(text))).indices]).toEqual([0, 1, 2, 0, 2, 3]);
});

test('ReadMesh.Numbers at the vertices of a PLY file keep their names', async () => {
  const text =
    'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' +
    'property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n' +
    '0 0 0 5\n1 0 0 6\n0 1 0 7\n3 0 1 2\n';
  expect(plyScalars(bytes(text))).toEqual(['heat']);
  const { attributes } = await readMesh('a.ply', bytes(text));
  expect(attributes).toEqual([{ name: 'heat', size: 1, values: Float32Array.of(5, 6, 7) }]);
});

test.each([
  ['a.off', 'OFF\n3 1 0\n0 0 0\n', 'shorter than its counts'],
  ['a.off', 'OFF\n1 1 0\n0 0 0\n3 0 1 2\n', 'a vertex that is not there'],
  ['a.obj', '# nothing\n', 'no triangles'],
  ['a.xyz', '0 0 0', 'ends in one of .obj'],
])('ReadMesh.Broken file %s says what is wrong: %s', async (name, text, words) => {
  const error = await readMesh(name, bytes(text)).catch((e: unknown) => e);
  expect(error).toBeInstanceOf(MeshFileError);
  expect((error as Error).message).toContain(words);
});

test('Draco.Mesh comes back bit for bit and in order', async () => {
  const surface = await readMesh('torus.off', bytes(asOff(mesh)));
  const encoded = encodeDraco(await createEncoderModule(), surface);
  expect(corners(decodeDraco(await createDecoderModule(), encoded))).toEqual(expected);
});

test('Draco.Bytes that are none are refused', async () => {
  const draco = await createDecoderModule();
  expect(() => decodeDraco(draco, bytes('not a mesh at all'))).toThrow(MeshFileError);
});

/** A copy of `values` with another value at `index`. */
function changed(values: Float32Array, index: number, value: number): Float32Array {
  const copy = values.slice();
  copy[index] = value;
  return copy;
}

/** A triangle whose corners are vertices 2, 5 and 8 of nine, with numbers at all of them. */
const sparse = {
  positions: Float32Array.from({ length: 27 }, (_, i) => Math.sin(i)),
  indices: Uint32Array.of(8, 2, 5),
  uvs: Float32Array.from({ length: 18 }, (_, i) => i / 18),
  attributes: [{ name: 'heat', size: 1, values: Float32Array.from({ length: 9 }, (_, i) => 10 * i) }],
};

test('Draco.Mesh with more vertices than corners comes back without those of no face', async () => {
  const encoded = encodeDraco(await createEncoderModule(), sparse);
  const decoded = decodeDraco(await createDecoderModule(), encoded);
  expect(decoded.positions.length).toBe(9);
  expect(corners(decoded)).toEqual(corners(sparse));
});

test('Draco.Vertices of no face stay where there is room, for the server to count', async () => {
  const positions = Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 7, 7, 7]);
  const surface = { positions, indices: Uint32Array.of(0, 1, 2, 0, 2, 3), attributes: [] };
  const encoded = encodeDraco(await createEncoderModule(), surface);
  expect([...decodeDraco(await createDecoderModule(), encoded).positions]).toEqual([...positions]);
});

test('UnusedVertices.Left out ones take their numbers with them', () => {
  expect(withoutUnusedVertices(sparse)).toEqual({
    positions: Float32Array.from([6, 7, 8, 15, 16, 17, 24, 25, 26], Math.sin),
    indices: Uint32Array.of(2, 0, 1),
    uvs: Float32Array.from([4, 5, 10, 11, 16, 17], (i) => i / 18),
    attributes: [{ name: 'heat', size: 1, values: Float32Array.of(20, 50, 80) }],
  });
});

test.each([
  ['a corner that is not there', { ...sparse, indices: Uint32Array.of(0, 1, 2, 3, 4, 9) }, /triangle 1 .* the 9 vertices/],
  ['no number', { ...sparse, positions: changed(sparse.positions, 4, NaN) }, /vertex 1 .* 32-bit float/],
  ['too large a number', { ...sparse, positions: changed(sparse.positions, 26, 1e39) }, /vertex 8 .* 32-bit float/],
])('Draco.Mesh with %s is refused with its place', async (_, surface, words) => {
  const draco = await createEncoderModule();
  expect(() => encodeDraco(draco, surface)).toThrow(MeshFileError);
  expect(() => encodeDraco(draco, surface)).toThrow(words);
});
