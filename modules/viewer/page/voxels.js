// SPDX-License-Identifier: BSD-3-Clause
// OctoMap's occupied voxels as cubes: the free faces of each, without the lower ones. All in one geometry, because software WebGL
// draws each instance of an instanced geometry separately.
import {BufferAttribute, BufferGeometry, DoubleSide, Mesh, ShaderMaterial} from "./three/build/three.module.js";
import {COLOR_FRAGMENT, CUT_GLSL, RAMP_GLSL, shared} from "./colors.js";
import {bytesOf} from "./decode.js";
import {setPose} from "./frames.js";

/** The faces: the step to the neighbour, and the brightness. Top, front, back, left, right. */
const FACES = [
  {step: [0, 0, 1], light: 0.95}, {step: [1, 0, 0], light: 0.58}, {step: [-1, 0, 0], light: 0.66},
  {step: [0, 1, 0], light: 0.74}, {step: [0, -1, 0], light: 0.82},
];
/** Two triangles: corners of a square from -1 to 1. */
const SQUARE = [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]];

const VERTEX = `${RAMP_GLSL}
attribute vec4 voxel;
uniform float ceilingM;
varying vec3 color;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  color = voxel.w * heightColor((modelMatrix * vec4(voxel.xyz, 1.0)).z);
  gl_Position = projectionMatrix * viewMatrix * world;
  ${CUT_GLSL}
}`;
const material = new ShaderMaterial({
  uniforms: {ceilingM: shared.ceilingM}, vertexShader: VERTEX, fragmentShader: COLOR_FRAGMENT, side: DoubleSide});

/** A foxglove.VoxelGrid with a uint8 field `occupied`, as {cells, columns, rows, slices, size}; cells without padding, x fastest. */
function occupancyOf(grid) {
  const bytes = bytesOf(grid.data);
  const field = grid.fields.find(({name}) => name === "occupied");
  const [columns, rows] = [grid.column_count, grid.row_count];
  const slices = Math.floor(bytes.length / grid.slice_stride);
  const cells = new Uint8Array(columns * rows * slices);
  for (let z = 0, to = 0; z < slices; ++z) {
    for (let y = 0; y < rows; ++y) {
      const from = z * grid.slice_stride + y * grid.row_stride + field.offset;
      for (let x = 0; x < columns; ++x) {
        cells[to++] = bytes[from + x * grid.cell_stride];
      }
    }
  }
  return {cells, columns, rows, slices, size: {...grid.cell_size}};
}

/** The same with voxels of twice the edge, occupied if one of the eight parts is. */
function coarser({cells, columns, rows, slices, size}) {
  const half = (count) => Math.ceil(count / 2);
  const coarse = {columns: half(columns), rows: half(rows), slices: half(slices), size: {x: 2 * size.x, y: 2 * size.y, z: 2 * size.z}};
  coarse.cells = new Uint8Array(coarse.columns * coarse.rows * coarse.slices);
  cells.forEach((occupied, i) => {
    if (occupied) {
      const x = i % columns;
      const y = Math.floor(i / columns) % rows;
      const z = Math.floor(i / (columns * rows));
      coarse.cells[((z >> 1) * coarse.rows + (y >> 1)) * coarse.columns + (x >> 1)] = 1;
    }
  });
  return coarse;
}

/** The free faces: for each [x, y, z of its voxel's centre relative to the grid's corner, index in FACES]. */
function freeFacesOf({cells, columns, rows, slices, size}) {
  const free = [];
  const isOccupied = (x, y, z) => x >= 0 && x < columns && y >= 0 && y < rows && z >= 0 && z < slices && cells[(z * rows + y) * columns + x];
  cells.forEach((occupied, i) => {
    if (!occupied) {
      return;
    }
    const x = i % columns;
    const y = Math.floor(i / columns) % rows;
    const z = Math.floor(i / (columns * rows));
    FACES.forEach(({step: [dx, dy, dz]}, face) => {
      if (!isOccupied(x + dx, y + dy, z + dz)) {
        free.push([(x + 0.5) * size.x, (y + 0.5) * size.y, (z + 0.5) * size.z, face]);
      }
    });
  });
  return free;
}

/** Triangles of the faces. Each corner has the centre of its voxel and the brightness of its face. */
function geometryOf(free, {size}) {
  const corners = new Float32Array(free.length * SQUARE.length * 3);
  const voxels = new Float32Array(free.length * SQUARE.length * 4);
  let at = 0;
  for (const [x, y, z, face] of free) {
    const {step: [dx, dy, dz], light} = FACES[face];
    for (const [u, v] of SQUARE) {
      const [cx, cy, cz] = dz ? [u, v, dz] : dx ? [dx, u, v] : [u, dy, v];
      corners.set([x + 0.5 * size.x * cx, y + 0.5 * size.y * cy, z + 0.5 * size.z * cz], 3 * at);
      voxels.set([x, y, z, light], 4 * at);
      ++at;
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setAttribute("voxel", new BufferAttribute(voxels, 4));
  return geometry;
}

/** Returns a function that draws a foxglove.VoxelGrid with at most `maxFaces` faces; doubles the voxels' edge if necessary, as in an octree. */
export function drawVoxels(maxFaces) {
  return (grid) => {
    let occupancy = occupancyOf(grid);
    let free = freeFacesOf(occupancy);
    while (free.length > maxFaces) {
      occupancy = coarser(occupancy);
      free = freeFacesOf(occupancy);
    }
    const object = new Mesh(geometryOf(free, occupancy), material);
    object.userData = {free, edgeM: occupancy.size.x};
    setPose(object, grid.pose);
    return [object];
  };
}
