import type {
  Decoder,
  DecoderModule,
  EncoderModule,
  Mesh,
  MeshBuilder,
  Metadata,
  Status,
} from 'draco3d';
import { MeshFileError, type SurfaceMesh } from './surface_mesh';
import { checkSurface, withoutUnusedVertices } from './surface_checks';

// The published types leave these out.
type ArrayDecoder = Decoder & {
  DecodeArrayToMesh(data: Uint8Array, size: number, mesh: Mesh): Status;
};
type Builder = MeshBuilder & {
  SetMetadataForAttribute(mesh: Mesh, attribute: number, metadata: Metadata): boolean;
};

/**
 * Encodes a mesh without loss: faces in their order, coordinates as they are. `bits` in [1, 24] rounds
 * positions to so many bits instead; 0 does not. Draco's decoders refuse a mesh with more vertices than
 * its faces have corners: then vertices of no face are left out, as the command does.
 * @throws MeshFileError
 */
export function encodeDraco(draco: EncoderModule, given: SurfaceMesh, bits = 0): Uint8Array {
  checkSurface(given);
  const fits = given.positions.length / 3 <= given.indices.length;
  const surface = fits ? given : withoutUnusedVertices(given);
  const vertices = surface.positions.length / 3;
  const mesh = new draco.Mesh();
  const builder = new draco.MeshBuilder() as Builder;
  const metadata = new draco.MetadataBuilder();
  const encoder = new draco.Encoder();
  const bytes = new draco.DracoInt8Array();
  try {
    builder.AddFacesToMesh(mesh, surface.indices.length / 3, surface.indices);
    builder.AddFloatAttribute(mesh, draco.POSITION, vertices, 3, surface.positions);
    if (surface.uvs) builder.AddFloatAttribute(mesh, draco.TEX_COORD, vertices, 2, surface.uvs);
    for (const { name, size, values } of surface.attributes) {
      const id = builder.AddFloatAttribute(mesh, draco.GENERIC, vertices, size, values);
      const entry = new draco.Metadata();
      metadata.AddStringEntry(entry, 'name', name);
      builder.SetMetadataForAttribute(mesh, id, entry);
    }
    encoder.SetEncodingMethod(draco.MESH_SEQUENTIAL_ENCODING);
    if (bits > 0) encoder.SetAttributeQuantization(draco.POSITION, bits);
    const size = encoder.EncodeMeshToDracoBuffer(mesh, bytes);
    if (size <= 0) throw new MeshFileError('the mesh cannot be encoded: it has no valid triangle');
    return Uint8Array.from({ length: size }, (_, i) => bytes.GetValue(i) & 255);
  } finally {
    for (const object of [bytes, encoder, metadata, builder, mesh]) draco.destroy(object);
  }
}

/**
 * Decodes positions and triangles, all that is drawn.
 * @throws MeshFileError
 */
export function decodeDraco(draco: DecoderModule, data: Uint8Array): SurfaceMesh {
  const decoder = new draco.Decoder() as ArrayDecoder;
  const mesh = new draco.Mesh();
  try {
    const status = decoder.DecodeArrayToMesh(data, data.length, mesh);
    if (!status.ok()) throw new MeshFileError(`not a Draco mesh: ${status.error_msg()}`);
    const positions = new Float32Array(3 * mesh.num_points());
    const indices = new Uint32Array(3 * mesh.num_faces());
    const id = decoder.GetAttributeId(mesh, draco.POSITION);
    if (id < 0) throw new MeshFileError('the Draco mesh has no positions');
    copyOut(draco, positions.byteLength, (pointer) => {
      const attribute = decoder.GetAttribute(mesh, id);
      decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, draco.DT_FLOAT32, positions.byteLength, pointer);
      positions.set(new Float32Array(draco.HEAPF32.buffer, pointer, positions.length));
    });
    copyOut(draco, indices.byteLength, (pointer) => {
      decoder.GetTrianglesUInt32Array(mesh, indices.byteLength, pointer);
      indices.set(new Uint32Array(draco.HEAPF32.buffer, pointer, indices.length));
    });
    return { positions, indices, attributes: [] };
  } finally {
    draco.destroy(mesh);
    draco.destroy(decoder);
  }
}

function copyOut(draco: DecoderModule, bytes: number, copy: (pointer: number) => void): void {
  const pointer = draco._malloc(bytes);
  try {
    copy(pointer);
  } finally {
    draco._free(pointer);
  }
}
