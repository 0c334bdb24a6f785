// SPDX-License-Identifier: BSD-3-Clause
// The registered cloud, keyframe by keyframe.
import {BufferAttribute, BufferGeometry, Group, Points, ShaderMaterial} from "./three/build/three.module.js";
import {COLOR_FRAGMENT, CUT_GLSL, RAMP_GLSL, shared} from "./colors.js";
import {pointsOf} from "./decode.js";
import {setPose} from "./frames.js";
import {SplatQuad} from "./splat.js";

// The width of a point: near ones close up to surfaces, distant ones stay points.
const POINT_M = 0.03;

const VERTEX = `${RAMP_GLSL}
uniform float ceilingM;
uniform bool byAge;
uniform float focalPx;
uniform float newness;
varying vec3 color;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  color = byAge ? ramp(newness) : heightColor(world.z);
  gl_Position = projectionMatrix * viewMatrix * world;
  gl_PointSize = clamp(${POINT_M} * focalPx / gl_Position.w, 1.5, 5.0);
  ${CUT_GLSL}
}`;

/** Shuffles points, so that the first n are a fair sample of all. */
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

const keyOf = ({sec, nsec}) => `${sec}.${nsec}`;
const secondsOf = ({sec, nsec}) => sec + 1e-9 * nsec;

/**
 * All keyframes received. Draws as many of their points as `budget` allows, the same fraction of each keyframe; on the
 * processor if there is no graphics card (`software`).
 */
export class Cloud {
  constructor(software) {
    this.group = new Group();
    this.software = software;
    if (software) {
      this.group.add(new SplatQuad(() => this.keyframes.values()));
    }
    this.keyframes = new Map();  // by time, so that a keyframe sent again replaces itself
    this.poses = new Map();  // by time: the poses of keyframes after loop closures
    this.total = 0;
    this.maxPoints = Infinity;  // the server says how many it keeps itself; the oldest keyframes are dropped first
    this.budget = Infinity;
  }

  /**
   * Moves keyframes, including those not yet received, to their present poses, and removes those that the map does not
   * have any more. If none of them is known, 6D SLAM has begun another map.
   */
  move({times, poses}) {
    const keys = times.map(keyOf);
    const inMap = new Set(keys);
    if (this.poses.size > 0 && !keys.some((key) => this.poses.has(key))) {
      this.forgetAllBut(inMap);
    }
    // Older ones may only have been left out of a long message. The poses of newer ones may come later, unless they were
    // there before: then the map has begun again.
    const [firstS, lastS] = [Math.min(...times.map(secondsOf)), Math.max(...times.map(secondsOf))];
    this.forget(({timeS}, key) => timeS >= firstS && (timeS <= lastS || this.poses.has(key)) && !inMap.has(key));
    this.poses = new Map(keys.map((key, i) => [key, poses[i]]));
    this.keyframes.forEach((object, key) => {
      if (this.poses.has(key)) {
        setPose(object, this.poses.get(key));
      }
    });
  }

  add(message) {
    const key = keyOf(message.timestamp);
    this.remove(key);
    const points = pointsOf(message);
    shuffle(points);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(points, 3));
    const object = new Points(geometry, new ShaderMaterial({
      uniforms: {...shared, newness: {value: 1}}, vertexShader: VERTEX, fragmentShader: COLOR_FRAGMENT}));
    object.timeS = secondsOf(message.timestamp);
    object.visible = !this.software;
    setPose(object, this.poses.get(key) ?? message.pose);
    this.keyframes.set(key, object);
    this.group.add(object);
    this.total += points.length / 3;
    for (const oldest of this.keyframes.keys()) {
      if (this.total <= this.maxPoints || oldest === key) {
        break;
      }
      this.remove(oldest);
    }
    this.grade();
    this.distribute(this.budget);
  }

  remove(key) {
    const object = this.keyframes.get(key);
    if (object) {
      this.total -= object.geometry.attributes.position.count;
      this.group.remove(object);
      object.geometry.dispose();
      object.material.dispose();
      this.keyframes.delete(key);
    }
  }

  clear() {
    this.poses.clear();
    this.forgetAllBut(new Set());
  }

  forgetAllBut(keys) {
    this.forget((_, key) => !keys.has(key));
  }

  /** Removes the keyframes for which `isGone(object, key)`. */
  forget(isGone) {
    [...this.keyframes].filter(([key, object]) => isGone(object, key)).forEach(([key]) => this.remove(key));
  }

  /** Computes the age of each keyframe: 0 the oldest, 1 the newest. */
  grade() {
    const times = [...this.keyframes.values()].map(({timeS}) => timeS);
    const oldest = Math.min(...times);
    const span = Math.max(...times) - oldest;
    this.keyframes.forEach((object) => {
      object.material.uniforms.newness.value = span > 0 ? (object.timeS - oldest) / span : 1;
    });
  }

  distribute(budget) {
    this.budget = budget;
    const fraction = Math.min(1, budget / Math.max(this.total, 1));
    for (const object of this.keyframes.values()) {
      object.geometry.setDrawRange(0, Math.ceil(fraction * object.geometry.attributes.position.count));
    }
  }

  get drawn() {
    return Math.round(Math.min(this.budget, this.total));
  }
}
