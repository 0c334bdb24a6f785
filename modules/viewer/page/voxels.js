// SPDX-License-Identifier: BSD-3-Clause
// OctoMap's occupied voxels, as cubes.
import {
  BoxBufferGeometry, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, ShaderMaterial, Vector3,
} from "./three/build/three.module.js";
import {CUT_GLSL, RAMP_GLSL, shared} from "./colors.js";
import {bytesOf} from "./decode.js";
import {setPose} from "./frames.js";

// More cubes than this, and the grid is drawn with voxels of twice the edge, as an octree is.
const MAX_CUBES = 40000;

const VERTEX = `${RAMP_GLSL}
attribute vec3 center;
uniform vec3 edges;
uniform float ceilingM;
varying vec3 color;
void main() {
  vec4 world = modelMatrix * vec4(center + edges * position, 1.0);
  float light = 0.62 + 0.3 * normal.z - 0.12 * normal.x - 0.06 * normal.y;
  color = light * heightColor((modelMatrix * vec4(center, 1.0)).z);
  gl_Position = projectionMatrix * viewMatrix * world;
  ${CUT_GLSL}
}`;
const FRAGMENT = `
varying vec3 color;
void main() {
  gl_FragColor = vec4(color, 1.0);
}`;

const material = new ShaderMaterial({
  uniforms: {ceilingM: shared.ceilingM, edges: {value: new Vector3()}}, vertexShader: VERTEX, fragmentShader: FRAGMENT});

/** A foxglove.VoxelGrid with a uint8 field `occupied`, as {cells, columns, rows, slices, size}; cells without gaps, x fastest. */
export function occupancyOf(grid) {
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

/** The same with voxels of twice the edge: occupied where one of its eight parts is. */
export function coarser({cells, columns, rows, slices, size}) {
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

/** x, y, z of the centre of each occupied voxel, from the grid's corner. */
export function centersOf({cells, columns, rows, size}) {
  const centers = [];
  cells.forEach((occupied, i) => {
    if (occupied) {
      centers.push((i % columns + 0.5) * size.x, (Math.floor(i / columns) % rows + 0.5) * size.y,
          (Math.floor(i / (columns * rows)) + 0.5) * size.z);
    }
  });
  return new Float32Array(centers);
}

/** The objects that show a foxglove.VoxelGrid. */
export function drawVoxels(grid) {
  let occupancy = occupancyOf(grid);
  let centers = centersOf(occupancy);
  while (centers.length > 3 * MAX_CUBES) {
    occupancy = coarser(occupancy);
    centers = centersOf(occupancy);
  }
  const cubes = new InstancedBufferGeometry().copy(new BoxBufferGeometry(1, 1, 1));
  cubes.setAttribute("center", new InstancedBufferAttribute(centers, 3));
  cubes.maxInstancedCount = centers.length / 3;
  material.uniforms.edges.value.copy(occupancy.size);
  const object = new Mesh(cubes, material);
  object.frustumCulled = false;  // three.js knows the first cube only
  setPose(object, grid.pose);
  return [object];
}
