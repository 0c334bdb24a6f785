// SPDX-License-Identifier: BSD-3-Clause
// The canvas: renderer, light, floor and cameras.
import {
  AmbientLight, AxesHelper, Color, DirectionalLight, GridHelper, Object3D, PerspectiveCamera, Plane, Raycaster, Scene, Spherical, Vector2, Vector3,
  WebGLRenderer,
} from "./three/build/three.module.js";
import {OrbitControls} from "./three/examples/jsm/controls/OrbitControls.js";
import {shared} from "./colors.js";
import {Frames} from "./frames.js";

/** Background and grid lines; every tenth line is stronger. */
const THEMES = {
  dark: {background: 0x14181d, axis: 0x4a5561, line: 0x242b33},
  light: {background: 0xe4e8ec, axis: 0x98a2ad, line: 0xcdd4da},
};
const FLOOR_M = 40;  // with a line every metre
const FIELD_OF_VIEW_DEG = 55;
const FOLLOW_OFFSET = new Vector3(-4, -2.5, 4);
const TOP_OFFSET = new Vector3(0, -0.01, 14);
const KEY_TURN_RAD = 0.08;
const KEY_DISTANCE = 0.9;
const DRAG_PX = 4;

/** Null if the browser has no WebGL: then there is no scene, and the rest of the page works. */
function makeRenderer(canvas) {
  try {
    return new WebGLRenderer({canvas, antialias: false});
  } catch (error) {
    console.warn(`no 3D scene: ${error.message}`);
    return null;
  }
}

export class View {
  constructor(canvas) {
    Object3D.DefaultUp.set(0, 0, 1);
    this.canvas = canvas;
    Object.assign(this, {clickMode: "none", clickModeActs: []});
    this.renderer = makeRenderer(canvas);
    this.scene = new Scene();
    this.scene.add(new AmbientLight(0xffffff, 0.6));
    const sun = new DirectionalLight(0xffffff, 0.6);
    sun.position.set(-2, -3, 6);
    this.scene.add(sun);
    this.frames = new Frames(this.scene);
    this.scene.add(new AxesHelper(1));  // axes of the map: x red, y green, z blue, one metre each
    this.setTheme("dark");
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.05, 500);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableKeys = false;  // its keys pan; ours rotate
    this.controls.addEventListener("change", () => this.touch());
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    this.robot = new Vector3();
    this.setMode("follow");
  }

  /**
   * Calls `act(event)` for each click with the main button or with one finger that is not a drag. Does not use "click", which the camera's controls
   * suppress on touch screens.
   */
  onClick(act) {
    let down = null;  // none while a second finger moves the camera, or another button
    this.canvas.addEventListener("pointerdown", (event) => { down = event.isPrimary && event.button === 0 ? event : null; });
    this.canvas.addEventListener("pointerup", (event) => {
      if (down?.pointerId === event.pointerId && event.button === 0 && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) <= DRAG_PX) {
        act(event);
      }
    });
  }

  /** What a click in the scene does, one thing at a time: "goal", "measure", or "none": it tells what is there. */
  setClickMode(mode) {
    this.clickMode = mode;
    this.canvas.classList.toggle("picking", mode !== "none");
    this.clickModeActs.forEach((act) => act(mode));
  }

  /** Calls `act(mode)` at each change of the click mode. */
  onClickMode(act) {
    this.clickModeActs.push(act);
  }

  /** Marks the image as changed. */
  touch() {
    this.isTouched = true;
  }

  setTheme(name) {
    const theme = THEMES[name];
    this.scene.background = new Color(theme.background);
    if (this.floor) {
      this.scene.remove(this.floor);
      this.floor.geometry.dispose();
    }
    this.floor = new GridHelper(FLOOR_M, FLOOR_M, theme.axis, theme.line);
    this.floor.rotation.x = Math.PI / 2;  // the helper is in the plane of x and z
    this.floor.position.z = -0.01;
    this.scene.add(this.floor);
    this.touch();
  }

  /** "follow" moves the camera with the robot, "top" looks straight down on it, "free" leaves it where it is. */
  setMode(mode) {
    this.mode = mode;
    this.controls.enableRotate = mode !== "top";
    if (mode === "top") {
      this.camera.position.copy(this.robot).add(TOP_OFFSET);
      this.controls.target.copy(this.robot);
    } else if (mode === "follow") {
      this.camera.position.copy(this.robot).add(FOLLOW_OFFSET);
      this.controls.target.copy(this.robot);
    }
    this.touch();
  }

  /** Arrow keys rotate the camera around the point that it looks at; plus and minus change the distance. */
  onKey(event) {
    const turn = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    const distance = {"+": KEY_DISTANCE, "-": 1 / KEY_DISTANCE}[event.key];
    if (!turn && !distance) {
      return;
    }
    event.preventDefault();
    const offset = this.camera.position.clone().sub(this.controls.target);
    const at = new Spherical().setFromCartesianCoords(offset.x, offset.z, -offset.y);  // in three.js y points up
    if (turn && this.mode !== "top") {
      at.theta += KEY_TURN_RAD * turn[0];
      at.phi = Math.min(Math.max(at.phi + KEY_TURN_RAD * turn[1], 0.01), Math.PI - 0.01);
    }
    at.radius *= distance ?? 1;
    offset.setFromSpherical(at);
    this.camera.position.copy(this.controls.target).add(new Vector3(offset.x, -offset.z, offset.y));
    this.touch();
  }

  /** Moves the camera with the robot. */
  track() {
    const at = new Vector3().setFromMatrixPosition(this.frames.matrixOf("base"));
    if (this.mode !== "free") {
      const step = at.clone().sub(this.robot);
      this.camera.position.add(step);
      this.controls.target.add(step);
    }
    this.robot.copy(at);
  }

  resize() {
    if (!this.renderer) {
      return;
    }
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const ratio = Math.min(window.devicePixelRatio, 2);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(height, 1);
      this.camera.updateProjectionMatrix();
      shared.focalPx.value = 0.5 * this.canvas.height / Math.tan(0.5 * FIELD_OF_VIEW_DEG * Math.PI / 180);
      this.touch();
    }
  }

  /** Updates camera and canvas; returns whether the image has changed since the last call. */
  update() {
    this.resize();
    this.track();
    this.controls.update();
    const changed = this.isTouched;
    this.isTouched = false;
    return changed;
  }

  render() {
    this.renderer?.render(this.scene, this.camera);
  }

  /** The point on the floor under a click, in the root frame; null if the click points to the sky. */
  floorAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), 0), new Vector3());
  }
}
