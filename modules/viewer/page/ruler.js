// SPDX-License-Identifier: BSD-3-Clause
// Sizes in the scene: a scale bar, and the distance between two points on the floor.
import {BufferAttribute, BufferGeometry, Line, LineBasicMaterial} from "./three/build/three.module.js";
import {shared} from "./colors.js";

const MAX_BAR_PX = 120;
const LIFT_M = 0.03;

/** The longest of 1, 2 and 5 times a power of ten that is at most `metres`. */
function roundLength(metres) {
  const power = 10 ** Math.floor(Math.log10(metres));
  return [5, 2, 1].find((factor) => factor * power <= metres) * power;
}

/** Formats a length for people. */
function lengthText(metres) {
  return metres < 1 ? `${Math.round(100 * metres)} cm` : `${Number(metres.toFixed(2))} m`;
}

/** The scale bar. It is correct at the distance of the point that the camera looks at. */
export class ScaleBar {
  constructor(box, view) {
    Object.assign(this, {box, view, text: ""});
  }

  update() {
    const {camera, controls, canvas} = this.view;
    const cssPixelsPerMetre = shared.focalPx.value / camera.position.distanceTo(controls.target) * (canvas.clientWidth / Math.max(canvas.width, 1));
    const length = roundLength(MAX_BAR_PX / cssPixelsPerMetre);
    const text = lengthText(length);
    this.box.style.width = `${(length * cssPixelsPerMetre).toFixed(1)}px`;
    if (text !== this.text) {
      this.box.textContent = this.text = text;
    }
  }
}

/** Measures the distance between two clicks on the floor and reports it with `say(text)`. */
export class Measuring {
  constructor(button, view, say) {
    Object.assign(this, {button, view, say, ends: []});
    button.addEventListener("click", () => this.set(!this.isOn));
    view.onClickMode((mode) => this.show(mode === "measure"));
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.isOn) {
        this.set(false);
      }
    });
    view.onClick((event) => {
      if (this.isOn) {
        this.take(view.floorAt(event));
      }
    });
  }

  get isOn() {
    return this.view.clickMode === "measure";
  }

  set(on) {
    this.view.setClickMode(on ? "measure" : "none");
  }

  show(on) {
    this.button.setAttribute("aria-pressed", on);
    this.ends = [];
    this.draw();
    this.say(on ? "Click two places on the floor." : "");
  }

  take(at) {
    if (!at) {
      return;
    }
    this.ends = this.ends.length === 2 ? [at] : [...this.ends, at];
    this.draw();
    this.say(this.ends.length === 2 ? `${this.ends[0].distanceTo(this.ends[1]).toFixed(2)} m on the floor` : "Now click the other end.");
  }

  draw() {
    if (this.line) {
      this.view.scene.remove(this.line);
      this.line.geometry.dispose();
      this.line = null;
    }
    if (this.ends.length === 2) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(new Float32Array(this.ends.flatMap(({x, y, z}) => [x, y, z + LIFT_M])), 3));
      this.line = new Line(geometry, new LineBasicMaterial({color: 0xffffff, depthTest: false}));
      this.view.scene.add(this.line);
    }
    this.view.touch();
  }
}
