import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
} from 'three';
import type { SurfaceMesh } from '../mesh/surface_mesh';
import { colouring, type ColourBy, type Colouring, type SampledSurface } from './colouring';
import { coloursOf } from './colour_map';
import { hexagonalSpacing, triangleAreas } from './sample_measures';
import { SamplePoints } from './sample_points';
import { Stage } from './stage';

/** Most points of a preview that are asked for; the API gives no more than the first. */
export const PREVIEW_POINTS = 65536;
export const SOFTWARE_PREVIEW_POINTS = 8192;
const SOFTWARE_POINTS = 60_000;
// Lines between more samples than this are a solid colour.
const MOST_WIRED = 250_000;

/** What is drawn of a job. */
export interface Layers {
  surface: boolean;
  points: boolean;
  mesh: boolean;
}

/** The 3-D view of one job: its surface, the points as they move, in the end the mesh over them. */
export class JobView {
  readonly stage: Stage;
  private readonly points = new SamplePoints();
  private surface: Mesh | undefined;
  private faces: Mesh | undefined;
  private wires: LineSegments | undefined;
  private result: SampledSurface | undefined;
  private smoothFaces = new BufferGeometry();
  private readonly wireLift = { value: 0 };
  private framed = false;
  private layers: Layers = { surface: true, points: true, mesh: true };
  private area = 0;
  private readonly still = matchMedia('(prefers-reduced-motion: reduce)');

  /** @throws when the browser has no WebGL */
  constructor(private readonly box: HTMLElement) {
    this.stage = new Stage(box);
    this.stage.add(this.points.object);
  }

  get previewPoints(): number {
    return this.stage.software ? SOFTWARE_PREVIEW_POINTS : PREVIEW_POINTS;
  }

  /** How many points are drawn just now. */
  get shownPoints(): number {
    return this.points.shown;
  }

  /** Shows the sampled surface, shaded, underneath. */
  setSurface(mesh: SurfaceMesh): void {
    this.area ||= triangleAreas(mesh.positions, mesh.indices).reduce((sum, area) => sum + area, 0);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
    geometry.setIndex(new BufferAttribute(mesh.indices, 1));
    geometry.computeVertexNormals();
    this.surface = new Mesh(
      geometry,
      new MeshLambertMaterial({
        side: DoubleSide,
        polygonOffset: true,
        polygonOffsetFactor: 2,
        polygonOffsetUnits: 2,
      }),
    );
    this.surface.renderOrder = -1;
    this.restyle();
    geometry.computeBoundingBox();
    this.frame(geometry.boundingBox ?? new Box3());
    this.stage.add(this.surface);
  }

  /** Moves the points to a preview, P x 3. `drawn` is called when they are on screen. */
  showPreview(positions: Float32Array, drawn?: () => void): void {
    if (this.result) return;
    this.points.move(positions, Infinity, !this.still.matches && !this.stage.software);
    if (!this.framed) this.frame(this.points.bounds());
    this.restyle();
    this.glide();
    this.stage.invalidate(drawn);
  }

  /** Shows what came out. */
  showResult(result: SampledSurface, drawn?: () => void): void {
    this.result = result;
    this.area = result.area;
    const { samples, triangles } = result;
    const limit = this.stage.software ? SOFTWARE_POINTS : Infinity;
    this.points.move(samples.positions, limit, false);
    if (!this.framed) this.frame(this.points.bounds());
    if (triangles.length > 0) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(samples.positions, 3));
      geometry.setAttribute('normal', new BufferAttribute(samples.normals, 3));
      geometry.setIndex(new BufferAttribute(triangles, 1));
      this.smoothFaces = geometry;
      this.faces = new Mesh(geometry, new MeshLambertMaterial({ side: DoubleSide }));
      this.faces.visible = false;
      this.stage.add(this.faces);
      if (samples.count <= MOST_WIRED) {
        this.wires = new LineSegments(edgesOf(geometry, triangles), this.wireMaterial());
        this.stage.add(this.wires);
      }
    }
    this.restyle();
    this.stage.invalidate(drawn);
  }

  /** Colours the samples and the mesh over them; returns what the legend says. */
  colourBy(by: ColourBy): Colouring | undefined {
    const chosen = this.result ? colouring(this.result, by) : undefined;
    const colours = chosen ? coloursOf(chosen.samples, chosen.low, chosen.high) : undefined;
    this.points.colour(colours);
    if (this.faces) {
      const material = this.faces.material as MeshLambertMaterial;
      if (chosen && colours) this.paintFaces(this.faces, chosen, colours);
      material.vertexColors = colours !== undefined;
      material.needsUpdate = true;
    }
    this.show(this.layers);
    this.restyle();
    return chosen;
  }

  show(layers: Layers): void {
    this.layers = layers;
    const painted = (this.faces?.material as MeshLambertMaterial | undefined)?.vertexColors ?? false;
    this.points.object.visible = layers.points;
    if (this.wires) this.wires.visible = layers.mesh;
    if (this.faces) this.faces.visible = layers.mesh && painted;
    // It would stick out of the painted triangles, which cut its hollows off.
    if (this.surface) this.surface.visible = layers.surface && !(this.faces?.visible ?? false);
    this.stage.invalidate();
  }

  /** Takes the colours of the page again. */
  restyle(): void {
    const style = getComputedStyle(this.box);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    const count = this.points.shown;
    const height = this.box.clientHeight * (this.stage.software ? 1 : Math.min(2, devicePixelRatio));
    const spacing = this.area > 0 && count > 0 ? hexagonalSpacing(this.area, count) : 0;
    this.wireLift.value = 0.3 * spacing;
    this.points.style(colour('--view-point'), spacing, height / 2);
    (this.surface?.material as MeshLambertMaterial | undefined)?.color.set(colour('--view-surface'));
    (this.wires?.material as LineBasicMaterial | undefined)?.color.set(colour('--view-wire'));
    this.stage.recolour();
  }

  dispose(): void {
    for (const part of [this.surface, this.faces, this.wires]) {
      part?.geometry.dispose();
      (part?.material as MeshLambertMaterial | undefined)?.dispose();
    }
    this.smoothFaces.dispose();
    this.points.dispose();
    this.stage.dispose();
  }

  /** Each triangle in a colour of its own where it has a value, else blended between its corners. */
  private paintFaces(faces: Mesh, chosen: Colouring, colours: Float32Array): void {
    const { triangles, low, high } = chosen;
    if (triangles && this.wires) {
      const flat = this.smoothFaces.toNonIndexed();
      const ofTriangles = coloursOf(triangles, low, high);
      const corners = new Float32Array(3 * ofTriangles.length);
      for (let corner = 0; corner < 3 * triangles.length; ++corner) {
        const triangle = Math.floor(corner / 3);
        corners.set(ofTriangles.subarray(3 * triangle, 3 * triangle + 3), 3 * corner);
      }
      flat.setAttribute('color', new BufferAttribute(corners, 3));
      faces.geometry = flat;
    } else {
      this.smoothFaces.setAttribute('color', new BufferAttribute(colours, 3));
      faces.geometry = this.smoothFaces;
    }
  }

  /** Lines that are drawn in front of the surface whose hollows and bulges they cut off. */
  private wireMaterial(): LineBasicMaterial {
    const material = new LineBasicMaterial({ transparent: true, opacity: 0.45 });
    material.onBeforeCompile = (shader) => {
      shader.uniforms['lift'] = this.wireLift;
      shader.vertexShader = shader.vertexShader
        .replace('void main() {', 'uniform float lift;\nvoid main() {')
        .replace(
          '#include <project_vertex>',
          `#include <project_vertex>
          mvPosition.xyz *= 1.0 - min(0.5, lift / -mvPosition.z);
          gl_Position = projectionMatrix * mvPosition;`,
        );
    };
    return material;
  }

  private frame(box: Box3): void {
    this.framed = true;
    this.stage.lookAt(box);
  }

  private glide(): void {
    if (this.points.animate(performance.now())) this.stage.invalidate(() => this.glide());
  }
}

/** The three sides of each triangle as lines between the vertices of `geometry`. */
function edgesOf(geometry: BufferGeometry, triangles: Uint32Array): BufferGeometry {
  const lines = new Uint32Array(2 * triangles.length);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const following = corner % 3 === 2 ? corner - 2 : corner + 1;
    lines[2 * corner] = triangles[corner] ?? 0;
    lines[2 * corner + 1] = triangles[following] ?? 0;
  }
  const edges = new BufferGeometry();
  edges.setAttribute('position', geometry.getAttribute('position'));
  edges.setIndex(new BufferAttribute(lines, 1));
  return edges;
}
