import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  Points,
  ShaderMaterial,
  type Sphere,
} from 'three';

const vertexShader = `
  attribute vec3 previous;
  attribute vec3 colour;
  uniform float moved;
  uniform float size;
  uniform float lift;
  uniform vec3 plain;
  uniform float coloured;
  varying vec3 shade;
  void main() {
    vec4 place = modelViewMatrix * vec4(mix(previous, position, moved), 1.0);
    // Towards the eye, in front of the surface they lie on.
    place.xyz *= 1.0 - min(0.5, lift / -place.z);
    gl_Position = projectionMatrix * place;
    gl_PointSize = clamp(size * projectionMatrix[1][1] / -place.z, 1.5, 24.0);
    shade = mix(plain, colour, coloured);
  }
`;
const fragmentShader = `
  varying vec3 shade;
  void main() {
    vec2 offset = gl_PointCoord - 0.5;
    if (dot(offset, offset) > 0.25) discard;
    gl_FragColor = vec4(shade, 1.0);
    #include <colorspace_fragment>
  }
`;
const MOVE_MS = 180;

/** Points that glide from where they were to where they are. */
export class SamplePoints {
  readonly object: Points<BufferGeometry, ShaderMaterial>;
  private readonly geometry = new BufferGeometry();
  private readonly material = new ShaderMaterial({
    vertexShader,
    fragmentShader,
    uniforms: {
      moved: { value: 1 },
      size: { value: 1 },
      lift: { value: 0 },
      plain: { value: new Color() },
      coloured: { value: 0 },
    },
  });
  private movedSince = 0;

  constructor() {
    this.object = new Points(this.geometry, this.material);
    // The bounds change with every preview; what is shown is always in view.
    this.object.frustumCulled = false;
  }

  get shown(): number {
    return this.geometry.drawRange.count === Infinity ? 0 : this.geometry.drawRange.count;
  }

  /**
   * Puts points at `positions`, N x 3, of which the first `limit` are drawn: samples come in an order
   * in which every prefix is well spread. They glide there when `glide` and there were as many before.
   */
  move(positions: Float32Array, limit: number, glide: boolean): void {
    const before = this.geometry.getAttribute('position') as BufferAttribute | undefined;
    const glides = glide && before?.array.length === positions.length;
    const previous = glides ? (before.array as Float32Array) : positions;
    const count = positions.length / 3;
    if (before?.array.length !== positions.length) {
      this.geometry.setAttribute('colour', new BufferAttribute(new Float32Array(3 * count), 3));
    }
    this.geometry.setAttribute('previous', new BufferAttribute(previous, 3));
    this.geometry.setAttribute('position', new BufferAttribute(positions, 3));
    this.geometry.setDrawRange(0, Math.min(limit, count));
    this.material.uniforms['moved']!.value = glides ? 0 : 1;
    this.movedSince = performance.now();
  }

  /** Goes on with the movement; false when it is over. */
  animate(now: number): boolean {
    const share = Math.min(1, (now - this.movedSince) / MOVE_MS);
    const moved = this.material.uniforms['moved']!;
    if (moved.value === 1) return false;
    moved.value = share * share * (3 - 2 * share);
    if (share === 1) moved.value = 1;
    return true;
  }

  /** N x 3 colours, or undefined for the plain one. */
  colour(colours: Float32Array | undefined): void {
    if (colours) this.geometry.setAttribute('colour', new BufferAttribute(colours, 3));
    this.material.uniforms['coloured']!.value = colours ? 1 : 0;
  }

  /** `plain` is a CSS colour. `spacing` between samples in mesh units, `height` of the view in pixels. */
  style(plain: string, spacing: number, height: number): void {
    (this.material.uniforms['plain']!.value as Color).set(plain);
    this.material.uniforms['size']!.value = 0.22 * spacing * height;
    this.material.uniforms['lift']!.value = 0.4 * spacing;
  }

  bounds(): Box3 {
    this.geometry.computeBoundingSphere();
    const sphere = this.geometry.boundingSphere as Sphere;
    return sphere.getBoundingBox(new Box3());
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }
}
