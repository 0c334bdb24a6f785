// SPDX-License-Identifier: BSD-3-Clause
// Materials of surfaces, lines, points and texts. Each is created once and kept, because a new one may compile shaders.
import {
  CanvasTexture, Color, GreaterDepth, LineBasicMaterial, MeshLambertMaterial, PointsMaterial, SpriteMaterial,
} from "./three/build/three.module.js";

// The number of text materials kept; texts contain numbers that change all the time.
const MAX_WORDS = 32;

const made = new Map();
const words = new Map();

function once(key, make) {
  if (!made.has(key)) {
    made.set(key, make());
  }
  return made.get(key);
}

/** `color` as 0xrrggbb, `size` in pixels. */
export function pointMaterial(color, size) {
  return once(`point ${color} ${size}`, () => new PointsMaterial({color, size, sizeAttenuation: false}));
}

/** `color` as 0xrrggbb. */
export function lineMaterial(color, opacity = 1) {
  return once(`line ${color} ${opacity}`, () => new LineBasicMaterial({color, transparent: opacity < 1, opacity}));
}

/** `color` as {r, g, b, a}, 0 to 1 each. */
export function solidMaterial({r, g, b, a}) {
  return once(`solid ${r} ${g} ${b} ${a}`, () => new MeshLambertMaterial({
    color: new Color(r, g, b), transparent: a < 1, opacity: a, depthWrite: a >= 1}));
}

/** The same material, faint, for parts behind other objects. */
export function hiddenMaterial(material) {
  return once(`hidden ${material.uuid}`, () => {
    const hidden = material.clone();
    return Object.assign(hidden, {transparent: true, opacity: 0.4, depthFunc: GreaterDepth, depthWrite: false});
  });
}

/** A text on a dark plate, in an image eight times as wide as high. */
export function wordsMaterial(text, {r, g, b}) {
  const color = `rgb(${255 * r}, ${255 * g}, ${255 * b})`;
  const key = `${text} ${color}`;
  if (!words.has(key)) {
    const oldest = words.size < MAX_WORDS ? undefined : words.keys().next().value;
    if (oldest !== undefined) {
      words.get(oldest).map.dispose();
      words.delete(oldest);
    }
    words.set(key, new SpriteMaterial({map: new CanvasTexture(written(text, color)), depthTest: false, sizeAttenuation: false}));
  }
  return words.get(key);
}

function written(text, color) {
  const canvas = document.createElement("canvas");
  canvas.width = 512;
  canvas.height = 64;
  const context = canvas.getContext("2d");
  context.font = "600 30px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  const width = Math.min(context.measureText(text).width, 490) + 20;
  context.fillStyle = "rgba(20, 24, 29, 0.75)";
  context.fillRect(256 - 0.5 * width, 8, width, 48);
  context.fillStyle = color;
  context.fillText(text, 256, 33, 490);
  return canvas;
}
