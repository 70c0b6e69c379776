import { createDecoderModule, createEncoderModule } from 'draco3d';
import { expect, test } from 'vitest';
import { decodeDraco, encodeDraco } from '../../../client/web/src/mesh/draco';
import { plyScalars, readMesh } from '../../../client/web/src/mesh/read_mesh';
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
