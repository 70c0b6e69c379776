/** A number, or up to four, at each vertex, by the name that densities use. */
export interface VertexAttribute {
  name: string;
  /** Values a vertex. */
  size: number;
  /** V x size, row major. */
  values: Float32Array;
}

/** Triangles in space as they travel between reader, worker and view. */
export interface SurfaceMesh {
  /** V x 3, row major, in mesh units. */
  positions: Float32Array;
  /** F x 3, indices into the vertices. */
  indices: Uint32Array;
  /** V x 2, where the mesh has texture coordinates. */
  uvs?: Float32Array;
  attributes: VertexAttribute[];
}

/** Why a file cannot be read; the message says what would be right. */
export class MeshFileError extends Error {}
