// SPDX-License-Identifier: BSD-3-Clause
// The colours of heights and ages: one ramp, used by the shaders and the legend.

/** From low or old to high or new; all bright enough for the dark background. */
const STOPS = [[72, 118, 255], [38, 190, 205], [120, 210, 95], [252, 216, 72], [255, 106, 74]];

/** The heights at the ends of the ramp, metres. */
export const HEIGHTS_M = [0, 2];

const glslColor = (stop) => `vec3(${stop.map((part) => (part / 255).toFixed(3)).join(", ")})`;

/** `vec3 ramp(float share)` for a shader; share from 0 to 1. */
export const RAMP_GLSL = `
vec3 ramp(float share) {
  float at = ${(STOPS.length - 1).toFixed(1)} * clamp(share, 0.0, 1.0);
  vec3 color = ${glslColor(STOPS[0])};
  ${STOPS.slice(1).map((stop, i) => `color = mix(color, ${glslColor(stop)}, clamp(at - ${i}.0, 0.0, 1.0));`).join("\n  ")}
  return color;
}
vec3 heightColor(float height) {
  return ramp((height - ${HEIGHTS_M[0].toFixed(1)}) / ${(HEIGHTS_M[1] - HEIGHTS_M[0]).toFixed(1)});
}`;

/** The ramp as a background of the legend, low at the left. */
export function rampCss() {
  return `linear-gradient(to right, ${STOPS.map((stop) => `rgb(${stop.join(", ")})`).join(", ")})`;
}

/**
 * Uniforms that the shaders of the scene share: everything above `ceilingM` is cut off, so that one can look into a room;
 * at a distance of `focalPx` metres, a metre is one pixel.
 */
export const shared = {ceilingM: {value: 2}, byAge: {value: false}, focalPx: {value: 600}};

/** For a vertex shader, after gl_Position is set: moves a cut-off vertex out of the image. */
export const CUT_GLSL = "if (world.z > ceilingM) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); }";

/** A fragment shader: the colour that the vertex shader has computed. */
export const COLOR_FRAGMENT = `
varying vec3 color;
void main() {
  gl_FragColor = vec4(color, 1.0);
}`;
