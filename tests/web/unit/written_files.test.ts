import { expect, test } from 'vitest';
import { AttributeKind } from '@api/sampling_service_pb';
import type { Writable } from '../../../client/web/src/export/write_mesh';
import { writeCsv, writeObj } from '../../../client/web/src/export/write_mesh';
import { writeGlb } from '../../../client/web/src/export/write_glb';
import { writePly } from '../../../client/web/src/export/write_ply';
import { readMesh } from '../../../client/web/src/mesh/read_mesh';

const content: Writable = {
  samples: {
    count: 3,
    positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0),
    normals: Float32Array.of(0, 0, 1, 0, 0, 1, 0, 0, 1),
    faces: Int32Array.of(5, 6, 7),
    barycentrics: Float64Array.of(0.1, 0.2, 0.3, 0.4, 0.5, 0.25),
    attributes: [
      { name: 'heat', kind: AttributeKind.SCALAR, size: 1, values: Float32Array.of(1, 2, 3) },
      { name: 'c', kind: AttributeKind.COLOR, size: 3, values: Float32Array.of(0, 0.5, 1, 0, 0, 0, 1, 1, 1) },
    ],
  },
  triangles: Uint32Array.of(0, 1, 2),
  origin: [1e7, 0, 0],
};
const bytesOf = async (blob: Blob) => new Uint8Array(await blob.arrayBuffer());

test('WritePly.Columns are those of the command', async () => {
  const bytes = await bytesOf(writePly(content));
  const text = new TextDecoder('latin1').decode(bytes);
  const end = text.indexOf('end_header\n') + 'end_header\n'.length;
  expect([...text.slice(0, end).matchAll(/property (?!list)\w+ (\w+)/g)].map((m) => m[1])).toEqual(
    'x y z nx ny nz face bary_u bary_v heat red green blue'.split(' '),
  );
  const view = new DataView(bytes.buffer, end);
  const stride = 3 * 8 + 3 * 4 + 4 + 2 * 8 + 4 + 3;
  expect(view.getFloat64(stride, true)).toBe(1e7 + 1);
  expect(view.getInt32(stride + 36, true)).toBe(6);
  expect(view.getFloat64(stride + 40, true)).toBe(0.3);
  expect(view.getFloat32(stride + 56, true)).toBe(2);
  expect([60, 61, 62].map((k) => view.getUint8(k))).toEqual([0, 128, 255]);
  expect(bytes.length).toBe(end + 3 * stride + 13);
});

test('WriteCsv.Numbers come back as they were', async () => {
  const rows = (await writeCsv(content).text()).trim().split('\n');
  expect(rows[0]).toBe('x,y,z,nx,ny,nz,face,bary_u,bary_v,heat,c_0,c_1,c_2');
  expect(rows[2]?.split(',').map(Number)).toEqual([1e7 + 1, 0, 0, 0, 0, 1, 6, 0.3, 0.4, 2, 0, 0, 0]);
});

test.each([
  ['mesh.obj', writeObj],
  ['mesh.ply', writePly],
  ['mesh.glb', writeGlb],
])('Write.Triangles of %s are read again', async (name, write) => {
  const mesh = await readMesh(name, await bytesOf(await write({ ...content, origin: [0, 0, 0] })));
  const places = [...mesh.indices].flatMap((i) => [...mesh.positions.subarray(3 * i, 3 * i + 3)]);
  expect(places).toEqual([...content.samples.positions]);
});

test('WriteGlb.File is a binary glTF of its own length', async () => {
  const bytes = await bytesOf(await writeGlb(content));
  const view = new DataView(bytes.buffer);
  expect(view.getUint32(0, true)).toBe(0x46546c67);
  expect(view.getUint32(8, true)).toBe(bytes.length);
});
