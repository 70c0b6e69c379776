import { MeshFileError, type SurfaceMesh } from './surface_mesh';

/**
 * Holds a mesh against what the encoder relies on, which checks nothing itself: corners that are there,
 * and coordinates that a 32-bit float holds.
 * @throws MeshFileError
 */
export function checkSurface({ positions, indices }: SurfaceMesh): void {
  const vertices = positions.length / 3;
  const outside = indices.findIndex((corner) => corner >= vertices);
  if (outside >= 0) {
    throw new MeshFileError(
      `triangle ${Math.floor(outside / 3)} (counted from 0) has a corner outside the ${vertices} vertices`,
    );
  }
  const infinite = positions.findIndex((coordinate) => !Number.isFinite(coordinate));
  if (infinite >= 0) {
    throw new MeshFileError(
      `vertex ${Math.floor(infinite / 3)} (counted from 0) has a coordinate that is no finite 32-bit float; ` +
        'scale the mesh down or correct the file',
    );
  }
}

/** The mesh with only those vertices that a triangle has as a corner, in the order they had. */
export function withoutUnusedVertices(surface: SurfaceMesh): SurfaceMesh {
  const used = new Uint8Array(surface.positions.length / 3);
  for (const corner of surface.indices) used[corner] = 1;
  const kept: number[] = [];
  const place = new Uint32Array(used.length);
  used.forEach((isUsed, vertex) => {
    if (isUsed) place[vertex] = kept.push(vertex) - 1;
  });
  const keptOf = (values: Float32Array, size: number): Float32Array => {
    const rows = new Float32Array(size * kept.length);
    kept.forEach((from, to) => rows.set(values.subarray(size * from, size * (from + 1)), size * to));
    return rows;
  };
  return {
    positions: keptOf(surface.positions, 3),
    indices: surface.indices.map((corner) => place[corner] ?? 0),
    ...(surface.uvs ? { uvs: keptOf(surface.uvs, 2) } : {}),
    attributes: surface.attributes.map((a) => ({ ...a, values: keptOf(a.values, a.size) })),
  };
}
