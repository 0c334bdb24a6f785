// SPDX-License-Identifier: BSD-3-Clause
// The registered cloud, keyframe by keyframe, with a level of detail that keeps the picture moving.
import {BufferAttribute, BufferGeometry, Group, Points, PointsMaterial} from "./three/build/three.module.js";
import {pointsOf} from "./decode.js";
import {setPose} from "./frames.js";

const MIN_BUDGET = 50000;
// As many as the server keeps by default: the oldest keyframes go first.
const MAX_POINTS = 2e6;
const TARGET_FRAME_MS = 40;
// The mean of frame times follows slowly: a change is judged when it has taken effect.
const FRAMES_PER_CHANGE = 15;
const HEIGHT_MIN_M = 0;
const HEIGHT_MAX_M = 2;

/** The colour of a height: blue below, over green, to red above (0..1 each). */
export function heightColor(height) {
  const h = Math.min(Math.max((height - HEIGHT_MIN_M) / (HEIGHT_MAX_M - HEIGHT_MIN_M), 0), 1);
  const ramp = (centre) => Math.min(Math.max(1.5 - Math.abs(4 * h - centre), 0), 1);
  return [ramp(3), ramp(2), ramp(1)];
}

/** Colours for points whose height is the row (a, b, c, d) of their transform. */
export function colorsByHeight(points, elements) {
  const colors = new Uint8Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    const height = elements[2] * points[i] + elements[6] * points[i + 1] + elements[10] * points[i + 2] + elements[14];
    const [r, g, b] = heightColor(height);
    colors[i] = 255 * r;
    colors[i + 1] = 255 * g;
    colors[i + 2] = 255 * b;
  }
  return colors;
}

/** Puts points into an order in which any first part of them is a fair sample of all. */
function shuffle(points) {
  let state = 1;
  for (let i = points.length / 3 - 1; i > 0; --i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    const j = state % (i + 1);
    for (let k = 0; k < 3; ++k) {
      const p = points[3 * i + k];
      points[3 * i + k] = points[3 * j + k];
      points[3 * j + k] = p;
    }
  }
}

/** All keyframes received. Draws as many of their points as `budget` allows, each keyframe its share. */
export class Cloud {
  constructor() {
    this.group = new Group();
    this.keyframes = new Map();  // by time: a keyframe sent again replaces itself
    this.total = 0;
    this.budget = 1e6;
    this.frames = 0;
    this.material = new PointsMaterial({size: 2, sizeAttenuation: false, vertexColors: true});
  }

  add(message) {
    const key = `${message.timestamp.sec}.${message.timestamp.nsec}`;
    this.remove(key);
    const points = pointsOf(message);
    shuffle(points);
    const object = new Points(new BufferGeometry(), this.material);
    setPose(object, message.pose);
    object.updateMatrix();
    object.geometry.setAttribute("position", new BufferAttribute(points, 3));
    object.geometry.setAttribute("color", new BufferAttribute(colorsByHeight(points, object.matrix.elements), 3, true));
    this.keyframes.set(key, object);
    this.group.add(object);
    this.total += points.length / 3;
    for (const oldest of this.keyframes.keys()) {
      if (this.total <= MAX_POINTS || oldest === key) {
        break;
      }
      this.remove(oldest);
    }
    this.share();
  }

  remove(key) {
    const object = this.keyframes.get(key);
    if (object) {
      this.total -= object.geometry.attributes.position.count;
      this.group.remove(object);
      object.geometry.dispose();
      this.keyframes.delete(key);
    }
  }

  clear() {
    [...this.keyframes.keys()].forEach((key) => this.remove(key));
  }

  /** Tells how long a frame takes now, so that the budget follows what this machine can draw. */
  onFrame(frameMs) {
    this.frames = (this.frames + 1) % FRAMES_PER_CHANGE;
    if (this.frames > 0) {
      return;
    }
    if (frameMs > 1.1 * TARGET_FRAME_MS && this.budget > MIN_BUDGET) {
      this.budget = Math.max(MIN_BUDGET, 0.7 * Math.min(this.budget, this.total));
    } else if (frameMs < 0.9 * TARGET_FRAME_MS && this.budget < this.total) {
      this.budget *= 1.2;
    }
    this.share();
  }

  share() {
    const fraction = Math.min(1, this.budget / Math.max(this.total, 1));
    for (const object of this.keyframes.values()) {
      object.geometry.setDrawRange(0, Math.ceil(fraction * object.geometry.attributes.position.count));
    }
  }

  get drawn() {
    return Math.round(Math.min(this.budget, this.total));
  }
}
