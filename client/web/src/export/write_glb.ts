import { Document, WebIO } from '@gltf-transform/core';
import type { Writable } from './write_mesh';

// Modes of the glTF specification.
const POINTS = 0;
const TRIANGLES = 4;

/**
 * Binary glTF with normals; samples without triangles become points. Positions are 32-bit floats: the
 * origin goes into the node that holds the mesh.
 */
export async function writeGlb({ samples, triangles, origin }: Writable): Promise<Blob> {
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (type: 'VEC3' | 'SCALAR', values: Float32Array | Uint32Array) =>
    document
      .createAccessor()
      .setType(type)
      .setArray(values as Float32Array<ArrayBuffer>)
      .setBuffer(buffer);
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor('VEC3', samples.positions))
    .setAttribute('NORMAL', accessor('VEC3', samples.normals))
    .setMode(triangles ? TRIANGLES : POINTS);
  if (triangles) primitive.setIndices(accessor('SCALAR', triangles));
  const mesh = document.createMesh('samples').addPrimitive(primitive);
  document.createScene().addChild(document.createNode().setMesh(mesh).setTranslation(origin));
  const bytes = await new WebIO().writeBinary(document);
  return new Blob([bytes as Uint8Array<ArrayBuffer>], { type: 'model/gltf-binary' });
}
