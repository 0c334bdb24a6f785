// SPDX-License-Identifier: BSD-3-Clause
// From messages to objects of the scene, in the frame that the message names.
import {
  BoxBufferGeometry, BufferAttribute, BufferGeometry, CylinderBufferGeometry, DataTexture, Line, LineSegments, Mesh, MeshBasicMaterial,
  NearestFilter, PlaneBufferGeometry, Points, RGBAFormat, Sprite,
} from "./three/build/three.module.js";
import {beamEndsOf, bytesOf, pointsOf} from "./decode.js";
import {setPose} from "./frames.js";
import {lineMaterial, pointMaterial, solidMaterial, wordsMaterial} from "./materials.js";

const LASER_COLOR = 0xff5252;
const KEYFRAME_COLOR = 0xffe082;
// Fraction of the canvas, at any distance.
const WORDS_HEIGHT = 0.05;
const LINE_LIST = 2;  // of foxglove.LinePrimitive

function geometryOf(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  return geometry;
}

/** Draws the laser's beams as a faint fan, and their ends. */
export function drawScan(scan) {
  const ends = beamEndsOf(scan);
  const beams = new Float32Array(2 * ends.length);
  for (let i = 0; i < ends.length; i += 3) {
    beams.set(ends.subarray(i, i + 3), 2 * i);  // from the mirror, which is the origin, to the end
  }
  const objects = [
    new LineSegments(geometryOf(beams), lineMaterial(LASER_COLOR, 0.18)), new Points(geometryOf(ends), pointMaterial(LASER_COLOR, 4)),
  ];
  objects.forEach((object) => setPose(object, scan.pose));
  return objects;
}

/** Returns a function that draws clouds in one colour, with points of `size` pixels. */
export function drawPoints(color, size) {
  return (cloud) => {
    const object = new Points(geometryOf(pointsOf(cloud)), pointMaterial(color, size));
    setPose(object, cloud.pose);
    return [object];
  };
}

/** A function that draws a foxglove.Grid of one byte a cell; `paint(value)`: [red, green, blue, opacity] of 255, or nothing. */
export function drawGrid(paint, liftM = 0) {
  const material = new MeshBasicMaterial({map: new DataTexture(), transparent: true, depthWrite: false});
  return (grid) => {
    const cells = new Int8Array(bytesOf(grid.data).buffer);
    const width = grid.column_count;
    const height = cells.length / grid.row_stride;
    const pixels = new Uint8Array(4 * cells.length);
    cells.forEach((value, i) => {
      const color = paint(value);
      if (color) {
        pixels.set(color, 4 * i);
      }
    });
    material.map.dispose();
    material.map = new DataTexture(pixels, width, height, RGBAFormat);
    material.map.magFilter = NearestFilter;
    material.map.needsUpdate = true;
    const plane = new PlaneBufferGeometry(width * grid.cell_size.x, height * grid.cell_size.y);
    plane.translate(0.5 * width * grid.cell_size.x, 0.5 * height * grid.cell_size.y, liftM);
    const object = new Mesh(plane, material);
    setPose(object, grid.pose);
    return [object];
  };
}

/** Free cells light, occupied ones dark red; unknown ones are left out. */
export function paintOccupancy(occupancy) {
  const share = occupancy / 100;
  return occupancy < 0 ? null : [90 + 140 * share, 105 - 60 * share, 125 - 80 * share, 150 + 90 * share];
}

/** By local_map_t: floor, obstacle, hole; what was not seen is left out. */
export function paintGround(kind) {
  return [null, [70, 160, 110, 110], [255, 120, 40, 230], [190, 60, 255, 230]][kind];
}

/** Positions of a foxglove.PosesInFrame, raised by `liftM`, so that they are not hidden in other drawings. */
function positionsOf(poses, liftM) {
  return new Float32Array(poses.poses.flatMap(({position: p}) => [p.x, p.y, p.z + liftM]));
}

export function drawTrail(color) {
  return (poses) => [new Line(geometryOf(positionsOf(poses, 0.02)), lineMaterial(color))];
}

export function drawKeyframes(poses) {
  return [new Points(geometryOf(positionsOf(poses, 0.05)), pointMaterial(KEYFRAME_COLOR, 8))];
}

function drawSolid(solid, geometry) {
  const mesh = new Mesh(geometry, solidMaterial(solid.color));
  setPose(mesh, solid.pose);
  // Not flat, because a scale of 0 has no inverse.
  mesh.scale.set(Math.max(solid.size.x, 1e-3), Math.max(solid.size.y, 1e-3), Math.max(solid.size.z, 1e-3));
  return mesh;
}

function drawLine({type, points, color}) {
  const geometry = geometryOf(new Float32Array(points.flatMap(({x, y, z}) => [x, y, z])));
  const material = lineMaterial((Math.round(255 * color.r) << 16) + (Math.round(255 * color.g) << 8) + Math.round(255 * color.b));
  return type === LINE_LIST ? new LineSegments(geometry, material) : new Line(geometry, material);
}

function drawText({text, color, pose}) {
  const sprite = new Sprite(wordsMaterial(text, color));
  sprite.scale.set(8 * WORDS_HEIGHT, WORDS_HEIGHT, 1);
  setPose(sprite, pose);
  return sprite;
}

/** Draws the cubes, cylinders, lines and texts of a foxglove.SceneEntity. */
export function drawEntity(entity) {
  const upright = () => new CylinderBufferGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2);
  return [
    ...entity.cubes.map((cube) => drawSolid(cube, new BoxBufferGeometry(1, 1, 1))),
    ...entity.cylinders.map((cylinder) => drawSolid(cylinder, upright())), ...entity.lines.map(drawLine), ...entity.texts.map(drawText),
  ];
}
