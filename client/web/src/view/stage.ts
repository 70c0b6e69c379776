import {
  Box3,
  Color,
  DirectionalLight,
  HemisphereLight,
  type Object3D,
  PerspectiveCamera,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

const KEY_STEP = 0.12;

/**
 * A canvas with a camera that circles what it shows. Draws only when something has changed, so that a
 * page left open costs nothing.
 */
export class Stage {
  readonly scene = new Scene();
  /** Drawn by the processor: fewer points, no animation. */
  readonly software: boolean;
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(40, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly sizes: ResizeObserver;
  private readonly scheme = matchMedia('(prefers-color-scheme: dark)');
  private frame = 0;
  private afterFrame: (() => void)[] = [];
  private linked: Stage | undefined;

  /** @throws when the browser has no WebGL */
  constructor(private readonly box: HTMLElement) {
    this.renderer = new WebGLRenderer({ antialias: true });
    this.software = isSoftware(this.renderer);
    this.renderer.setPixelRatio(this.software ? 1 : Math.min(2, devicePixelRatio));
    const canvas = this.renderer.domElement;
    box.append(canvas);
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.addEventListener('keydown', (event) => this.onKey(event));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => {
      this.linked?.copyView(this);
      this.invalidate();
    });
    this.scene.add(new HemisphereLight(0xffffff, 0x667788, 1.6));
    const lamp = new DirectionalLight(0xffffff, 1.6);
    lamp.position.set(-0.6, 0.9, 1);
    this.camera.add(lamp);
    this.scene.add(this.camera);
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(box);
    this.scheme.addEventListener('change', this.recolour);
    this.recolour();
    this.lookAt(new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1)));
  }

  /** What assistive technology reads in place of the picture. */
  describe(text: string): void {
    this.renderer.domElement.setAttribute('aria-label', text);
  }

  add(object: Object3D): void {
    this.scene.add(object);
    this.invalidate();
  }

  /** Points the camera at `box` from a little above and fits it in. */
  lookAt(box: Box3): void {
    const sphere = box.getBoundingSphere(new Sphere());
    const distance = (0.9 * sphere.radius) / Math.sin((this.camera.fov * Math.PI) / 360);
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(sphere.center);
    this.camera.position
      .copy(sphere.center)
      .add(new Vector3(0.45, 0.3, 1).normalize().multiplyScalar(distance));
    this.controls.update();
    this.invalidate();
  }

  /** From now on, both look from the same side. */
  link(other: Stage): void {
    this.linked = other;
    other.linked = this;
    other.copyView(this);
  }

  /** Draws with the next frame; `after` is called once it is drawn. */
  invalidate(after?: () => void): void {
    if (after) this.afterFrame.push(after);
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.scene, this.camera);
      const called = this.afterFrame;
      this.afterFrame = [];
      for (const call of called) call();
    });
  }

  /** The colours of the page have changed. */
  readonly recolour = (): void => {
    const colour = getComputedStyle(this.box).backgroundColor;
    this.scene.background = new Color(colour);
    this.invalidate();
  };

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.scheme.removeEventListener('change', this.recolour);
    this.sizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.renderer.domElement.remove();
  }

  private copyView(from: Stage): void {
    if (this.camera.position.equals(from.camera.position)) return;
    this.camera.position.copy(from.camera.position);
    this.controls.target.copy(from.controls.target);
    this.camera.near = from.camera.near;
    this.camera.far = from.camera.far;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.invalidate();
  }

  private onKey(event: KeyboardEvent): void {
    const turns: Record<string, [number, number, number]> = {
      ArrowLeft: [-KEY_STEP, 0, 1],
      ArrowRight: [KEY_STEP, 0, 1],
      ArrowUp: [0, -KEY_STEP, 1],
      ArrowDown: [0, KEY_STEP, 1],
      '+': [0, 0, 0.88],
      '=': [0, 0, 0.88],
      '-': [0, 0, 1 / 0.88],
    };
    const turn = turns[event.key];
    if (!turn || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const arm = this.camera.position.clone().sub(this.controls.target).multiplyScalar(turn[2]);
    arm.applyAxisAngle(new Vector3(0, 1, 0), turn[0]);
    const side = new Vector3(0, 1, 0).cross(arm).normalize();
    const tilted = arm.clone().applyAxisAngle(side, turn[1]);
    // Not over the top.
    if (Math.abs(tilted.y) < 0.98 * tilted.length()) arm.copy(tilted);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }
}

function isSoftware(renderer: WebGLRenderer): boolean {
  const gl = renderer.getContext();
  const names = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
