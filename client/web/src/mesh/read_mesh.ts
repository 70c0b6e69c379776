import type { BufferGeometry, Mesh, Object3D } from 'three';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import { extensionOf, MESH_EXTENSIONS } from './mesh_file_names';
import { readGlb } from './read_glb';
import { readOff } from './read_off';
import { MeshFileError, type SurfaceMesh, type VertexAttribute } from './surface_mesh';

const KNOWN_PLY = new Set(
  'x y z nx ny nz s t u v texture_u texture_v red green blue alpha r g b diffuse_red diffuse_green diffuse_blue'.split(' '),
);

/** Names of vertex properties of a PLY that are neither position, normal, colour nor texture. */
export function plyScalars(bytes: Uint8Array): string[] {
  const text = new TextDecoder('latin1').decode(bytes.subarray(0, 16384));
  const header = text.slice(0, text.indexOf('end_header'));
  const vertex = /^element vertex [^\n]*\n((?:property [^\n]*\n|comment [^\n]*\n)*)/m.exec(header);
  const names = [...(vertex?.[1] ?? '').matchAll(/^property (?!list)\w+ (\S+)\s*$/gm)];
  return names.map((match) => match[1] ?? '').filter((name) => !KNOWN_PLY.has(name));
}

function fromGeometry(geometry: BufferGeometry, scalars: string[]): SurfaceMesh {
  const positions = geometry.getAttribute('position');
  if (!positions) throw new MeshFileError('the file has no vertices');
  const uv = geometry.getAttribute('uv');
  const indices = geometry.index
    ? Uint32Array.from(geometry.index.array)
    : Uint32Array.from({ length: positions.count }, (_, i) => i);
  const attributes: VertexAttribute[] = [];
  for (const name of scalars) {
    const values = geometry.getAttribute(`scalar_${name}`);
    if (values) attributes.push({ name, size: 1, values: Float32Array.from(values.array) });
  }
  return {
    positions: Float32Array.from(positions.array),
    indices,
    ...(uv ? { uvs: Float32Array.from(uv.array) } : {}),
    attributes,
  };
}

function join(parts: SurfaceMesh[]): SurfaceMesh {
  const [only, ...others] = parts;
  if (!only) throw new MeshFileError('the file has no triangles');
  if (others.length === 0) return only;
  const vertices = parts.reduce((sum, part) => sum + part.positions.length, 0);
  const positions = new Float32Array(vertices);
  const indices = new Uint32Array(parts.reduce((sum, part) => sum + part.indices.length, 0));
  const textured = parts.every((part) => part.uvs);
  const uvs = new Float32Array(textured ? (vertices / 3) * 2 : 0);
  let vertex = 0;
  let index = 0;
  for (const part of parts) {
    positions.set(part.positions, 3 * vertex);
    if (part.uvs && textured) uvs.set(part.uvs, 2 * vertex);
    for (const corner of part.indices) indices[index++] = corner + vertex;
    vertex += part.positions.length / 3;
  }
  return { positions, indices, ...(textured ? { uvs } : {}), attributes: [] };
}

function readObj(bytes: Uint8Array): SurfaceMesh {
  const parts: SurfaceMesh[] = [];
  new OBJLoader().parse(new TextDecoder().decode(bytes)).traverse((object: Object3D) => {
    if ('isMesh' in object) parts.push(fromGeometry((object as Mesh).geometry, []));
  });
  return join(parts);
}

function readPly(bytes: Uint8Array): SurfaceMesh {
  const loader = new PLYLoader();
  const scalars = plyScalars(bytes);
  loader.setCustomPropertyNameMapping(
    Object.fromEntries(scalars.map((name) => [`scalar_${name}`, [name]])),
  );
  const geometry = loader.parse(bytes.slice().buffer);
  if (!geometry.index) throw new MeshFileError('the PLY file has no faces: point clouds cannot be sampled');
  return fromGeometry(geometry, scalars);
}

/**
 * Reads a mesh by the ending of its file's name.
 * @throws MeshFileError
 */
export async function readMesh(fileName: string, bytes: Uint8Array): Promise<SurfaceMesh> {
  const mesh = await readAny(fileName, bytes);
  if (mesh.indices.length < 3) throw new MeshFileError(`${fileName} has no triangles`);
  return mesh;
}

async function readAny(fileName: string, bytes: Uint8Array): Promise<SurfaceMesh> {
  try {
    switch (extensionOf(fileName)) {
      case '.obj':
        return readObj(bytes);
      case '.ply':
        return readPly(bytes);
      case '.stl':
        return fromGeometry(new STLLoader().parse(bytes.slice().buffer), []);
      case '.off':
        return readOff(new TextDecoder().decode(bytes));
      case '.glb':
        return join(await readGlb(bytes));
    }
  } catch (error) {
    if (error instanceof MeshFileError) throw error;
    throw new MeshFileError(`${fileName} cannot be read: ${(error as Error).message}`);
  }
  throw new MeshFileError(
    `${fileName}: the name of a mesh file ends in one of ${MESH_EXTENSIONS.join(' ')}`,
  );
}
