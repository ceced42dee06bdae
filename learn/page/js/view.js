// The block in 3-D: surface, rod, inclusion, and a second surface beside it for the simulated poke. Millimetres, z up.

import {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, Color, DirectionalLight, DoubleSide,
  EdgesGeometry, HemisphereLight, LatheGeometry, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  PerspectiveCamera, Plane, Quaternion, Raycaster, RepeatWrapping, Scene, SRGBColorSpace, TOUCH, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Surface } from "./surface.js";

const TISSUE = new Color("#e9c9ae");
const UNSURE = new Color("#7a1fd1");
const GREY = new Color("#9a9a9a");
const UP = new Vector3(0, 0, 1);
const VIEWS = { slant: [0.42, -0.75, 0.52], above: [0, -0.01, 1], side: [0, -0.98, 0.2], close: [0.35, -0.8, 0.5] };

/** Whether WebGL runs on the processor: it then shares it with the network, and smoothed edges cost four times the pixels. */
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const known = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = known ? gl.getParameter(known.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class View {
  constructor(canvas, about, inclusions) {
    this.canvas = canvas;
    this.about = about;
    this.inclusions = inclusions; // Uint8Array (n * n, 2) an interior: first rigid level, and the level after the last
    this.renderer = new WebGLRenderer({ canvas, antialias: !drawsInSoftware(), alpha: true });
    this.renderer.setScissorTest(true);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(30, 1, 1, 2000);
    this.camera.up.copy(UP);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_ROTATE };
    this.controls.minDistance = 25;
    this.controls.maxDistance = 500;
    this.controls.maxPolarAngle = Math.PI * 0.6;
    this.controls.addEventListener("start", () => { this.standpoint = null; }); // turned by hand
    this.beside = false;
    this._light();
    this._block();
    this.surrogate = this._surface();
    this.simulated = this._surface();
    this.rod = this._rod();
    this.inclusion = null;
    this.look("slant");
  }

  _light() {
    this.scene.add(new HemisphereLight("#ffffff", "#8a7f78", 1.4), new AmbientLight("#ffffff", 0.35));
    const sun = new DirectionalLight("#ffffff", 2.2);
    sun.position.set(-60, -120, 160);
    this.scene.add(sun);
  }

  _block() {
    const { size, middle, top } = this.about.block;
    const box = new BoxGeometry(...size);
    const sides = new Mesh(box, new MeshLambertMaterial({
      color: TISSUE, transparent: true, opacity: 0.28, depthWrite: false,
    }));
    sides.position.set(middle[0], middle[1], top - size[2] / 2);
    sides.renderOrder = 1;
    const edges = new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({ color: "#6b5a4c" }));
    edges.position.copy(sides.position);
    // the box's own top face would lie in the deformed surface
    box.setIndex(Array.from(box.index.array).filter((_, k) => k < 24 || k >= 30));
    this.scene.add(sides, edges);
  }

  _surface() {
    const { size, middle, top } = this.about.block;
    const surface = new Surface(this.about.grid, size, middle, top);
    const geometry = new BufferGeometry();
    geometry.setIndex(new BufferAttribute(surface.triangles(), 1));
    geometry.setAttribute("position", new BufferAttribute(surface.positions, 3));
    geometry.setAttribute("normal", new BufferAttribute(surface.normals, 3));
    const colours = new Float32Array(surface.positions.length).fill(1);
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    const uv = new Float32Array(surface.count ** 2 * 2);
    for (let k = 0; k < surface.count ** 2; k++) {
      uv[2 * k] = (surface.rest[3 * k] - middle[0]) / 5; // lines 5 mm apart
      uv[2 * k + 1] = (surface.rest[3 * k + 1] - middle[1]) / 5;
    }
    geometry.setAttribute("uv", new BufferAttribute(uv, 2));
    const material = new MeshLambertMaterial({
      vertexColors: true, map: lines(), side: DoubleSide, forceSinglePass: true, transparent: true, opacity: 0.86,
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = 2;
    this.scene.add(mesh);
    return { surface, mesh, colours };
  }

  _rod() {
    const { radius, edge } = this.about.rod;
    const profile = [new Vector2(0, 0)];
    for (let k = 0; k <= 10; k++) {
      const t = (k / 10) * Math.PI / 2;
      profile.push(new Vector2(radius - edge + edge * Math.sin(t), edge * (1 - Math.cos(t))));
    }
    profile.push(new Vector2(radius, 45), new Vector2(0, 45));
    const geometry = new LatheGeometry(profile, 48).rotateX(Math.PI / 2); // its axis along z
    const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: "#5c6f82" }));
    this.scene.add(mesh);
    return mesh;
  }

  /** Show the inclusion of an interior as the network knows it: columns of cells. */
  showInterior(index) {
    if (this.inclusion) {
      this.scene.remove(this.inclusion);
      this.inclusion.geometry.dispose();
    }
    const geometry = columns(this.about, this.inclusions[index]);
    this.inclusion = new Mesh(geometry, new MeshLambertMaterial({ color: "#35506b", flatShading: true }));
    this.scene.add(this.inclusion);
  }

  /** Surface of "surrogate" or "simulated": displacement in metres, shade (n * n) from 0 to 1, and grey or not. */
  show(which, displacement, shade, grey, rod) {
    const { surface, mesh, colours } = this[which];
    surface.move(displacement, 1e3, rod);
    if (shade) surface.colour(shade);
    else surface.shade.fill(0);
    const base = grey ? GREY : TISSUE;
    for (let k = 0, p = 0; k < surface.shade.length; k++, p += 3) {
      const t = Math.min(Math.max(surface.shade[k], 0), 1);
      colours[p] = base.r + t * (UNSURE.r - base.r);
      colours[p + 1] = base.g + t * (UNSURE.g - base.g);
      colours[p + 2] = base.b + t * (UNSURE.b - base.b);
    }
    for (const name of ["position", "normal", "color"]) mesh.geometry.attributes[name].needsUpdate = true;
  }

  /** tip: where the rod's tip is now [mm]; push: its direction. */
  placeRod(tip, push) {
    this.rod.position.set(...tip);
    this.rod.quaternion.copy(new Quaternion().setFromUnitVectors(UP, new Vector3(-push[0], -push[1], -push[2])));
  }

  /** A standpoint by its name in VIEWS; "close" looks at where the rod is. */
  look(name) {
    const { size, middle, top } = this.about.block;
    const close = name === "close";
    if (close) this.controls.target.copy(this.rod.position);
    else this.controls.target.set(middle[0], middle[1], top - size[2] * 0.45);
    const half = close ? 24 : Math.hypot(size[0], size[1]) / 2; // of what is to be seen, across
    this.standpoint = { way: new Vector3(...VIEWS[name]).normalize(), half };
    this.resize();
  }

  zoom(factor) {
    this.standpoint = null;
    const { target } = this.controls;
    this.camera.position.sub(target).multiplyScalar(factor).add(target);
    this.controls.update();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    if (this.standpoint) {
      const { width: w, height: h } = this._panes()[0];
      const { way, half } = this.standpoint;
      const slope = Math.tan((this.camera.fov * Math.PI) / 360);
      const far = half * Math.max(1.16 / (slope * (w / h)), 0.98 / slope);
      this.camera.position.copy(this.controls.target).addScaledVector(way, far);
      this.controls.update();
    }
  }

  /** Parts of the canvas, from its lower left [px]: one, or two side by side, or one above the other. */
  _panes() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.beside) return [{ x: 0, y: 0, width, height }];
    if (width < 700) {
      const half = height / 2;
      return [{ x: 0, y: half, width, height: half }, { x: 0, y: 0, width, height: half }];
    }
    return [{ x: 0, y: 0, width: width / 2, height }, { x: width / 2, y: 0, width: width / 2, height }];
  }

  /** Where a pointer's ray meets the plane of the top [mm], and whether that is on the block. */
  under(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = event.clientX - box.left;
    const y = box.height - (event.clientY - box.top);
    const pane = this._panes().find((p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height);
    if (!pane) return null;
    const ray = new Raycaster();
    this.camera.aspect = pane.width / pane.height;
    this.camera.updateProjectionMatrix();
    const place = new Vector2(((x - pane.x) / pane.width) * 2 - 1, ((y - pane.y) / pane.height) * 2 - 1);
    ray.setFromCamera(place, this.camera);
    const { size, middle, top } = this.about.block;
    const hit = ray.ray.intersectPlane(new Plane(UP, -top), new Vector3());
    if (!hit) return null;
    const inside = Math.abs(hit.x - middle[0]) <= size[0] / 2 && Math.abs(hit.y - middle[1]) <= size[1] / 2;
    return { x: hit.x, y: hit.y, inside };
  }

  render() {
    this._panes().forEach((pane, k) => {
      this.surrogate.mesh.visible = k === 0;
      this.simulated.mesh.visible = k === 1;
      this.renderer.setViewport(pane.x, pane.y, pane.width, pane.height);
      this.renderer.setScissor(pane.x, pane.y, pane.width, pane.height);
      this.camera.aspect = pane.width / pane.height;
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
    });
  }
}

/** A texture of one cell of lines. */
function lines() {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 128;
  const pen = canvas.getContext("2d");
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, 128, 128);
  pen.strokeStyle = "#00000066";
  pen.lineWidth = 5;
  pen.strokeRect(0, 0, 128, 128);
  const texture = new CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.anisotropy = 2;
  texture.colorSpace = SRGBColorSpace;
  return texture;
}

/** Boxes of the rigid levels under each cell of the grid, without the faces between two of them. */
function columns(about, spans) {
  const { grid: n, levels } = about;
  const { size, middle, top } = about.block;
  const positions = [];
  const wide = [size[0] / n, size[1] / n];
  const z = (level) => top - (level * size[2]) / levels;
  const span = (r, c) => (r < 0 || c < 0 || r >= n || c >= n ? [0, 0] : [spans[2 * (r * n + c)], spans[2 * (r * n + c) + 1]]);
  const quad = (a, b, c, d) => positions.push(...a, ...b, ...c, ...a, ...c, ...d);
  const wall = (p, q, from, to) => {
    if (to > from) quad([...p, z(to)], [...q, z(to)], [...q, z(from)], [...p, z(from)]);
  };
  for (let r = 0; r < n; r++) {
    for (let c = 0; c < n; c++) {
      const [first, last] = span(r, c);
      if (last <= first) continue;
      const x = middle[0] - size[0] / 2 + c * wide[0];
      const y = middle[1] - size[1] / 2 + r * wide[1];
      const corners = [[x, y], [x + wide[0], y], [x + wide[0], y + wide[1]], [x, y + wide[1]]];
      quad(...corners.map((p) => [...p, z(first)]));
      quad(...corners.slice().reverse().map((p) => [...p, z(last)]));
      [[-1, 0], [0, 1], [1, 0], [0, -1]].forEach(([dr, dc], k) => {
        const [a, b] = span(r + dr, c + dc);
        const [p, q] = [corners[k], corners[(k + 1) % 4]];
        if (b <= a) wall(p, q, first, last);
        else {
          wall(p, q, first, Math.min(last, a));
          wall(p, q, Math.max(first, b), last);
        }
      });
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.computeVertexNormals();
  return geometry;
}
