// SPDX-License-Identifier: BSD-3-Clause
// Points drawn by the processor, for browsers without a graphics card: there, WebGL takes some microseconds for each point, this some
// nanoseconds. The points are put into a texture as colour and depth, which one quad lays over the scene.
import {DataTexture, Mesh, NearestFilter, PlaneBufferGeometry, RGBAFormat, ShaderMaterial, UnsignedByteType} from "./three/build/three.module.js";
import {HEIGHTS_M, RAMP_GLSL, shared} from "./colors.js";

// A point is a square with this many pixels along its edge; nearer than NEAR_M, twice as many.
const PIXELS = 2;
const NEAR_M = 4;
// A pixel of the texture: distance in the upper 24 bits, place on the colour ramp in the lower 8. The smaller value is nearer.
const EMPTY = 0xffffffff;
const MAX_DISTANCE = 0xffffff;

const VERTEX = `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = vec4(2.0 * position.xy, 0.0, 1.0);
}`;
const FRAGMENT = `${RAMP_GLSL}
uniform sampler2D points;
uniform float near;
uniform float far;
varying vec2 at;
void main() {
  vec4 point = 255.0 * texture2D(points, at);
  float share = (point.g + 256.0 * point.b + 65536.0 * point.a) / ${MAX_DISTANCE.toFixed(1)};
  if (share > 0.999) {
    discard;
  }
  gl_FragColor = vec4(ramp(point.r / 255.0), 1.0);
  gl_FragDepthEXT = far / (far - near) * (1.0 - near / max(share * far, near));
}`;

/** Whether this WebGL context draws without a graphics card. */
export function isSoftware(gl) {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  return /swiftshader|llvmpipe|software/i.test(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "");
}

/**
 * Puts points into `pixels` (width columns, height rows from below). `m` is the column-major matrix to the image, `up` the height
 * of a point in the world as (a, b, c, d); `unit` is the number of distance steps per metre; `newness` (0 to 1), if not null,
 * determines the colour instead of the height.
 */
export function splat(points, count, m, up, {pixels, width, height, unit, ceilingM, newness}) {
  const [a0, a1, , a3, b0, b1, , b3, c0, c1, , c3, d0, d1, , d3] = m;
  const heightScale = 255 / (HEIGHTS_M[1] - HEIGHTS_M[0]);
  const [halfWidth, halfHeight] = [0.5 * width, 0.5 * height];
  for (let i = 0; i < 3 * count; i += 3) {
    const x = points[i];
    const y = points[i + 1];
    const z = points[i + 2];
    const distance = a3 * x + b3 * y + c3 * z + d3;
    const worldZ = up[0] * x + up[1] * y + up[2] * z + up[3];
    if (distance < 0.05 || worldZ > ceilingM) {
      continue;
    }
    const column = halfWidth * ((a0 * x + b0 * y + c0 * z + d0) / distance + 1);
    const row = halfHeight * ((a1 * x + b1 * y + c1 * z + d1) / distance + 1);
    if (column < 0 || row < 0 || column >= width - 1 || row >= height - 1) {
      continue;
    }
    const color = newness === null ? Math.min(Math.max((worldZ - HEIGHTS_M[0]) * heightScale, 0), 255) : 255 * newness;
    const value = ((Math.min(distance * unit, MAX_DISTANCE) << 8) | color) >>> 0;
    const at = (row | 0) * width + (column | 0);
    if (value < pixels[at]) {
      pixels[at] = value;
    }
    if (distance < NEAR_M) {
      pixels[at + 1] = Math.min(value, pixels[at + 1]);
      pixels[at + width] = Math.min(value, pixels[at + width]);
      pixels[at + width + 1] = Math.min(value, pixels[at + width + 1]);
    }
  }
}

/** An object of the scene that shows a list of three.js's Points objects, within their draw ranges. */
export class SplatQuad extends Mesh {
  constructor(objects) {
    super(new PlaneBufferGeometry(1, 1), new ShaderMaterial({
      uniforms: {points: {value: null}, near: {value: 0}, far: {value: 0}},
      vertexShader: VERTEX, fragmentShader: FRAGMENT, extensions: {fragDepth: true}}));
    this.objects = objects;
    this.frustumCulled = false;  // it covers the whole image
    this.onBeforeRender = (renderer, scene, camera) => this.paint(renderer.domElement, camera);
  }

  resize(width, height) {
    if (this.pixels && width === this.width && height === this.height) {
      return;
    }
    Object.assign(this, {width, height, pixels: new Uint32Array(width * height)});
    this.texture?.dispose();
    this.texture = new DataTexture(new Uint8Array(this.pixels.buffer), width, height, RGBAFormat, UnsignedByteType);
    this.texture.magFilter = NearestFilter;
    this.texture.minFilter = NearestFilter;
    this.material.uniforms.points.value = this.texture;
  }

  paint(canvas, camera) {
    this.resize(Math.max(1, Math.floor(canvas.width / PIXELS)), Math.max(1, Math.floor(canvas.height / PIXELS)));
    this.material.uniforms.near.value = camera.near;
    this.material.uniforms.far.value = camera.far;
    this.pixels.fill(EMPTY);
    const {pixels, width, height} = this;
    for (const object of this.objects()) {
      const world = object.matrixWorld;
      const toImage = world.clone().premultiply(camera.matrixWorldInverse).premultiply(camera.projectionMatrix);
      const e = world.elements;
      splat(object.geometry.attributes.position.array, object.geometry.drawRange.count, toImage.elements, [e[2], e[6], e[10], e[14]], {
        pixels, width, height, unit: MAX_DISTANCE / camera.far, ceilingM: shared.ceilingM.value,
        newness: shared.byAge.value ? object.material.uniforms.newness.value : null});
    }
    this.texture.needsUpdate = true;
  }
}
