// SPDX-License-Identifier: BSD-3-Clause
// What can be shown and hidden: one layer for each kind of message, drawn in the frame that the message names.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, Color, CylinderGeometry, DataTexture, Group, Line, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, NearestFilter, PlaneGeometry, Points, PointsMaterial, RGBAFormat, Sprite,
  SpriteMaterial,
} from "./three/build/three.module.js";
import {Cloud} from "./cloud.js";
import {beamEndsOf, bytesOf, pointsOf} from "./decode.js";
import {setPose} from "./frames.js";

const LINE_LIST = 2;

function geometryOf(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  return geometry;
}

/** Empties a group and gives back what the graphics card held for it. */
function empty(group) {
  for (const child of [...group.children]) {
    group.remove(child);
    if (!child.isSprite) {  // all sprites share one geometry
      child.geometry?.dispose();
    }
    child.material?.map?.dispose();
    child.material?.dispose();
  }
}

/** A layer whose newest message replaces the one before. `draw(message)` returns the objects to show. */
class Layer {
  constructor(frames, draw) {
    this.frames = frames;
    this.draw = draw;
    this.group = new Group();
  }

  show(message, frame = message.frame_id) {
    empty(this.group);
    this.draw(message).forEach((object) => this.group.add(object));
    this.frames.group(frame).add(this.group);
  }

  clear() {
    empty(this.group);
  }
}

/** The laser's beams as a fan, faint, and their ends. */
function drawScan(scan) {
  const ends = beamEndsOf(scan);
  const beams = new Float32Array(2 * ends.length);
  for (let i = 0; i < ends.length; i += 3) {
    beams.set(ends.subarray(i, i + 3), 2 * i);  // from the mirror, which is the origin, to the end
  }
  const objects = [
    new LineSegments(geometryOf(beams), new LineBasicMaterial({color: 0xff5252, transparent: true, opacity: 0.18})),
    new Points(geometryOf(ends), new PointsMaterial({color: 0xff5252, size: 4, sizeAttenuation: false})),
  ];
  objects.forEach((object) => setPose(object, scan.pose));
  return objects;
}

function drawPoints(color, size) {
  return (cloud) => {
    const object = new Points(geometryOf(pointsOf(cloud)), new PointsMaterial({color, size, sizeAttenuation: false}));
    setPose(object, cloud.pose);
    return [object];
  };
}

/** Free cells light, occupied ones dark red, unknown ones not at all. */
function drawGrid(grid) {
  const cells = new Int8Array(bytesOf(grid.data).buffer);
  const width = grid.column_count;
  const height = cells.length / grid.row_stride;
  const pixels = new Uint8Array(4 * cells.length);
  cells.forEach((occupancy, i) => {
    if (occupancy >= 0) {
      const share = occupancy / 100;
      pixels.set([90 + 140 * share, 105 - 60 * share, 125 - 80 * share, 150 + 90 * share], 4 * i);
    }
  });
  const texture = new DataTexture(pixels, width, height, RGBAFormat);
  texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  const plane = new PlaneGeometry(width * grid.cell_size.x, height * grid.cell_size.y);
  plane.translate(0.5 * width * grid.cell_size.x, 0.5 * height * grid.cell_size.y, 0);
  const object = new Mesh(plane, new MeshBasicMaterial({map: texture, transparent: true, depthWrite: false}));
  setPose(object, grid.pose);
  return [object];
}

function drawTrail(color) {
  return (poses) => {
    const points = new Float32Array(poses.poses.flatMap(({position: p}) => [p.x, p.y, p.z + 0.02]));
    return [new Line(geometryOf(points), new LineBasicMaterial({color}))];
  };
}

function drawKeyframes(poses) {
  const points = new Float32Array(poses.poses.flatMap(({position: p}) => [p.x, p.y, p.z + 0.05]));
  return [new Points(geometryOf(points), new PointsMaterial({color: 0xffe082, size: 8, sizeAttenuation: false}))];
}

function materialOf(color) {
  return new MeshLambertMaterial({
    color: new Color(color.r, color.g, color.b), transparent: color.a < 1, opacity: color.a, depthWrite: color.a >= 1});
}

function textSprite(text) {
  const canvas = document.createElement("canvas");
  canvas.width = 512;
  canvas.height = 64;
  const context = canvas.getContext("2d");
  context.font = "36px system-ui, sans-serif";
  context.textAlign = "center";
  context.fillStyle = `rgb(${255 * text.color.r}, ${255 * text.color.g}, ${255 * text.color.b})`;
  context.fillText(text.text, 256, 44, 500);
  const sprite = new Sprite(new SpriteMaterial({map: new CanvasTexture(canvas), depthTest: false}));
  sprite.scale.set(3.2, 0.4, 1);
  setPose(sprite, text.pose);
  return sprite;
}

function drawEntity(entity) {
  const solids = (list, geometry) => list.map((solid) => {
    const mesh = new Mesh(geometry(), materialOf(solid.color));
    setPose(mesh, solid.pose);
    mesh.scale.set(Math.max(solid.size.x, 1e-3), Math.max(solid.size.y, 1e-3), Math.max(solid.size.z, 1e-3));
    return mesh;
  });
  const lines = entity.lines.map((line) => {
    const points = new Float32Array(line.points.flatMap(({x, y, z}) => [x, y, z]));
    const material = new LineBasicMaterial({color: new Color(line.color.r, line.color.g, line.color.b)});
    return line.type === LINE_LIST ? new LineSegments(geometryOf(points), material) : new Line(geometryOf(points), material);
  });
  const upright = () => new CylinderGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2);
  return [
    ...solids(entity.cubes, () => new BoxGeometry(1, 1, 1)), ...solids(entity.cylinders, upright), ...lines,
    ...entity.texts.map(textSprite),
  ];
}

/** A layer of SceneUpdates with one entity each. */
class EntityLayer extends Layer {
  constructor(frames) {
    super(frames, drawEntity);
  }

  show(update) {
    if (update.deletions.length > 0) {
      this.clear();
    }
    update.entities.forEach((entity) => super.show(entity));
  }
}

class CloudLayer {
  constructor(frames) {
    this.frames = frames;
    this.cloud = new Cloud();
    this.group = this.cloud.group;
  }

  show(message) {
    this.cloud.add(message);
    this.frames.group(message.frame_id).add(this.group);
  }

  clear() {
    this.cloud.clear();
  }
}

/** The layers by topic, with the name people see. The order is that of the list on the page. */
export function makeLayers(frames) {
  const entities = () => new EntityLayer(frames);
  // Drawn from the common start, not where odometry is now: so that the trails can be compared.
  const odometryTrail = new Layer(frames, drawTrail(0x9aa5b1));
  const showInFrame = odometryTrail.show.bind(odometryTrail);
  odometryTrail.show = (message) => showInFrame(message, "map");
  return new Map([
    ["scene/robot", {name: "robot", layer: entities()}],
    ["SCAN", {name: "laser fan", layer: new Layer(frames, drawScan)}],
    ["CLOUD", {name: "point cloud", layer: new CloudLayer(frames)}],
    ["MAP_2D", {name: "2D map", layer: new Layer(frames, drawGrid)}],
    ["OBSTACLE_MAP", {name: "obstacle map", layer: new Layer(frames, drawPoints(0xffb74d, 5))}],
    ["STRUCTURE_MAP", {name: "structure map", layer: new Layer(frames, drawPoints(0x4dd0e1, 5))}],
    ["scene/corridor", {name: "virtual corridor", layer: entities()}],
    ["scene/area_of_interest", {name: "area of interest", layer: entities()}],
    ["trail/odometry", {name: "odometry trail", layer: odometryTrail}],
    ["trail/2d", {name: "2D SLAM trail", layer: new Layer(frames, drawTrail(0x5fb3ff))}],
    ["trail/6d", {name: "6D SLAM trail", layer: new Layer(frames, drawTrail(0xffe082))}],
    ["keyframes", {name: "keyframes", layer: new Layer(frames, drawKeyframes)}],
    ["scene/goal", {name: "goal", layer: entities()}],
    ["scene/people", {name: "people", layer: entities()}],
  ]);
}
