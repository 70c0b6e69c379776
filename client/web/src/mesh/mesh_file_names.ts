/** Endings of the files that become jobs; .drc travels as it is. */
export const MESH_EXTENSIONS = ['.obj', '.ply', '.stl', '.off', '.glb', '.drc'];

export function extensionOf(fileName: string): string {
  return /\.[^.]+$/.exec(fileName.toLowerCase())?.[0] ?? '';
}
