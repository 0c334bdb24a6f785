// SPDX-License-Identifier: BSD-3-Clause
// The canvas: renderer, light, floor and cameras.
import {
  AmbientLight, Color, DirectionalLight, GridHelper, Object3D, PerspectiveCamera, Plane, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer,
} from "./three/build/three.module.js";
import {OrbitControls} from "./three/examples/jsm/controls/OrbitControls.js";
import {Frames} from "./frames.js";

const BACKGROUND = 0x14181d;

export class View {
  constructor(canvas) {
    Object3D.DefaultUp.set(0, 0, 1);
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({canvas, antialias: false, preserveDrawingBuffer: true});
    this.scene = new Scene();
    this.scene.background = new Color(BACKGROUND);
    this.scene.add(new AmbientLight(0xffffff, 0.6));
    const sun = new DirectionalLight(0xffffff, 0.6);
    sun.position.set(-2, -3, 6);
    this.scene.add(sun);
    this.frames = new Frames(this.scene);
    this.floor = new GridHelper(40, 40, 0x39424c, 0x242b33);
    this.floor.rotation.x = Math.PI / 2;  // the helper lies in x and z
    this.floor.position.z = -0.01;
    this.scene.add(this.floor);
    this.camera = new PerspectiveCamera(55, 1, 0.05, 500);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-4, -2.5, 4);
    this.controls = new OrbitControls(this.camera, canvas);
    this.robot = new Vector3();
    this.setMode("follow");
    this.frameMs = 16;
    this.lastMs = 0;
  }

  /** "follow" keeps the camera with the robot, "top" looks straight down on it, "free" stays. */
  setMode(mode) {
    this.mode = mode;
    this.controls.enableRotate = mode !== "top";
    if (mode === "top") {
      this.camera.position.copy(this.robot).add(new Vector3(0, -0.01, 14));
      this.controls.target.copy(this.robot);
    } else if (mode === "follow") {
      this.camera.position.copy(this.robot).add(new Vector3(-4, -2.5, 4));
      this.controls.target.copy(this.robot);
    }
  }

  /** Moves along with the robot. */
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
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const ratio = Math.min(window.devicePixelRatio, 2);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(height, 1);
      this.camera.updateProjectionMatrix();
    }
  }

  render(nowMs) {
    this.frameMs += 0.1 * (Math.min(nowMs - this.lastMs, 1000) - this.frameMs);
    this.lastMs = nowMs;
    this.resize();
    this.track();
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }

  /** Where on the floor a click points to, in the root frame; null where it points to the sky. */
  floorAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), 0), new Vector3());
  }
}
