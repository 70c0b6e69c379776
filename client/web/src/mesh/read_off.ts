import { MeshFileError, type SurfaceMesh } from './surface_mesh';

/**
 * Reads the Object File Format as text, also COFF, NOFF and STOFF (what follows a position is left
 * out). Polygons become fans of triangles.
 * @throws MeshFileError
 */
export function readOff(text: string): SurfaceMesh {
  const lines = text
    .split('\n')
    .map((line) => line.replace(/#.*$/, '').trim())
    .filter((line) => line !== '');
  const first = /^(?:ST)?C?N?OFF\b\s*(.*)$/.exec(lines[0] ?? '');
  if (!first || /binary/i.test(first[1] ?? '')) {
    throw new MeshFileError('an OFF file begins with a line OFF and is text');
  }
  let next = 1;
  const header = first[1] ? first[1] : lines[next++];
  const [vertexCount = NaN, faceCount = NaN] = (header ?? '').split(/\s+/).map(Number);
  if (!(vertexCount >= 0 && faceCount >= 0 && lines.length >= next + vertexCount + faceCount)) {
    throw new MeshFileError('the OFF file is shorter than its counts say');
  }
  const positions = new Float32Array(3 * vertexCount);
  for (let v = 0; v < vertexCount; ++v) {
    const numbers = (lines[next++] ?? '').split(/\s+/);
    for (let k = 0; k < 3; ++k) positions[3 * v + k] = Number(numbers[k]);
  }
  const indices: number[] = [];
  for (let f = 0; f < faceCount; ++f) {
    const [corners = 0, ...face] = (lines[next++] ?? '').split(/\s+/).map(Number);
    for (let k = 2; k < corners; ++k) {
      const triangle = [face[0] ?? NaN, face[k - 1] ?? NaN, face[k] ?? NaN];
      if (!triangle.every((i) => i >= 0 && i < vertexCount)) {
        throw new MeshFileError(`face ${f} of the OFF file names a vertex that is not there`);
      }
      indices.push(...triangle);
    }
  }
  return { positions, indices: Uint32Array.from(indices), attributes: [] };
}
