import { WebIO, type Node, type Primitive } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import { decoderModule } from './draco_modules';
import type { SurfaceMesh } from './surface_mesh';

// The mode of the glTF specification; strips and fans are left out.
const TRIANGLES = 4;

type Matrix = ReturnType<Node['getWorldMatrix']>;

function transformed(values: ArrayLike<number>, m: Matrix): Float32Array {
  const out = new Float32Array(values.length);
  for (let v = 0; v < values.length; v += 3) {
    const [x, y, z] = [values[v] ?? 0, values[v + 1] ?? 0, values[v + 2] ?? 0];
    out[v] = m[0] * x + m[4] * y + m[8] * z + m[12];
    out[v + 1] = m[1] * x + m[5] * y + m[9] * z + m[13];
    out[v + 2] = m[2] * x + m[6] * y + m[10] * z + m[14];
  }
  return out;
}

function fromPrimitive(primitive: Primitive, matrix: Matrix): SurfaceMesh | undefined {
  const position = primitive.getAttribute('POSITION')?.getArray();
  if (primitive.getMode() !== TRIANGLES || !position) return undefined;
  const index = primitive.getIndices()?.getArray();
  const uv = primitive.getAttribute('TEXCOORD_0');
  const uvs = new Float32Array(uv ? 2 * uv.getCount() : 0);
  for (let v = 0; uv && v < uv.getCount(); ++v) uvs.set(uv.getElement(v, []), 2 * v);
  const indices = index
    ? Uint32Array.from(index)
    : Uint32Array.from({ length: position.length / 3 }, (_, i) => i);
  // Application-defined attributes, `_NAME` in the file, are named as the command names them.
  const attributes = primitive
    .listSemantics()
    .filter((name) => name.startsWith('_') && primitive.getAttribute(name)?.getType() === 'SCALAR')
    .map((name) => ({
      name: name.slice(1),
      size: 1,
      values: Float32Array.from(primitive.getAttribute(name)?.getArray() ?? []),
    }));
  return {
    positions: transformed(position, matrix),
    indices,
    ...(uv ? { uvs } : {}),
    attributes,
  };
}

/** The triangles of every mesh in the scenes of a binary glTF, where its nodes put them. */
export async function readGlb(bytes: Uint8Array): Promise<SurfaceMesh[]> {
  const io = new WebIO();
  // The decoder is large, and few files need it.
  if (new TextDecoder('latin1').decode(bytes).includes(KHRDracoMeshCompression.EXTENSION_NAME)) {
    io.registerExtensions([KHRDracoMeshCompression]);
    io.registerDependencies({ 'draco3d.decoder': await decoderModule() });
  }
  const document = await io.readBinary(bytes);
  const parts: SurfaceMesh[] = [];
  for (const node of document.getRoot().listNodes()) {
    for (const primitive of node.getMesh()?.listPrimitives() ?? []) {
      const part = fromPrimitive(primitive, node.getWorldMatrix());
      if (part) parts.push(part);
    }
  }
  return parts;
}
