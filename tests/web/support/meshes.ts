/** A torus about z: major radius 1, minor 0.35, `u` by `v` quads cut in two. V x 3 and F x 3. */
export function torus(u = 48, v = 24): { positions: number[][]; faces: number[][] } {
  const positions: number[][] = [];
  const faces: number[][] = [];
  const at = (i: number, j: number) => (i % u) * v + (j % v);
  for (let i = 0; i < u; ++i) {
    for (let j = 0; j < v; ++j) {
      const [a, b] = [(2 * Math.PI * i) / u, (2 * Math.PI * j) / v];
      const r = 1 + 0.35 * Math.cos(b);
      positions.push([r * Math.cos(a), r * Math.sin(a), 0.35 * Math.sin(b)]);
      faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
    }
  }
  return { positions, faces };
}

/** The area of that torus were it round. */
export const TORUS_AREA = 4 * Math.PI * Math.PI * 0.35;

export function asObj({ positions, faces }: ReturnType<typeof torus>): string {
  const lines = positions.map((p) => `v ${p.join(' ')}`);
  for (const face of faces) lines.push(`f ${face.map((i) => i + 1).join(' ')}`);
  return lines.join('\n') + '\n';
}

export function asOff({ positions, faces }: ReturnType<typeof torus>): string {
  const lines = ['OFF', `${positions.length} ${faces.length} 0`];
  for (const p of positions) lines.push(p.join(' '));
  for (const face of faces) lines.push(`3 ${face.join(' ')}`);
  return lines.join('\n') + '\n';
}
