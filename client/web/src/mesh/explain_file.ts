import { explain, type Explanation } from '../api/explain';
import { MeshFileError } from './surface_mesh';

/** Why a dropped file did not become a job, in words. */
export function explainFile(error: unknown): Explanation {
  if (!(error instanceof MeshFileError)) return explain(error);
  return {
    title: 'The file cannot be read',
    advice: 'Drop an OBJ, PLY, STL, OFF, GLB or Draco file with triangles.',
    detail: error.message,
    reason: 'MESH_UNREADABLE',
    violations: [],
    transient: false,
    retryAfterMs: 0,
  };
}
