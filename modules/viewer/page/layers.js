// SPDX-License-Identifier: BSD-3-Clause
// Layers, which can be shown and hidden: one for each kind of message, drawn in the frame of the message.
import {Group} from "./three/build/three.module.js";
import {Cloud} from "./cloud.js";
import {drawEntity, drawGrid, drawKeyframes, drawPoints, drawScan, drawTrail, paintGround, paintOccupancy} from "./drawings.js";
import {hiddenMaterial} from "./materials.js";
import {drawVoxels} from "./voxels.js";

/** Empties a group and frees its memory on the graphics card; materials are kept. */
function empty(group) {
  for (const child of [...group.children]) {
    group.remove(child);
    if (!child.isSprite) {  // all sprites share one geometry
      child.geometry.dispose();
    }
  }
}

/**
 * A layer whose newest message replaces the previous one. `draw(message)` returns the objects to show; `frame` replaces the
 * frame of the message. A hidden layer is not drawn until it is shown.
 */
class Layer {
  constructor(frames, draw, frame) {
    this.frames = frames;
    this.draw = draw;
    this.frame = frame;
    this.group = new Group();
    this.waiting = null;
  }

  set visible(visible) {
    this.group.visible = visible;
    if (visible && this.waiting) {
      this.show(this.waiting);
    }
  }

  show(message) {
    this.waiting = this.group.visible ? null : message;
    if (!this.waiting) {
      this.place(message);
    }
  }

  place(message) {
    this.timeS = message.timestamp.sec + 1e-9 * message.timestamp.nsec;
    empty(this.group);
    this.draw(message).forEach((object) => this.group.add(object));
    this.frames.group(this.frame ?? message.frame_id).add(this.group);
  }

  /** The objects that a click can hit, with their times: [{object, timeS}]. */
  touchable() {
    return this.group.children.filter((object) => object.isPoints || object.isMesh).map((object) => ({object, timeS: this.timeS}));
  }

  clear() {
    this.waiting = null;
    empty(this.group);
  }
}

/** A layer of SceneUpdates with one entity each. */
class EntityLayer extends Layer {
  constructor(frames) {
    super(frames, drawEntity);
  }

  place(update) {
    if (update.deletions.length > 0) {
      this.clear();
    }
    update.entities.forEach((entity) => super.place(entity));
  }
}

/** The robot stays visible behind other objects, such as voxels: its largest part is also drawn there. */
class RobotLayer extends EntityLayer {
  place(update) {
    super.place(update);
    const volume = ({scale}) => scale.x * scale.y * scale.z;
    const [body] = this.group.children.filter(({isMesh}) => isMesh).sort((a, b) => volume(b) - volume(a));
    if (body) {
      const hidden = body.clone();
      hidden.material = hiddenMaterial(body.material);
      this.group.add(hidden);
    }
  }
}

class CloudLayer {
  constructor(frames, software) {
    this.frames = frames;
    this.cloud = new Cloud(software);
    this.group = this.cloud.group;
  }

  set visible(visible) {
    this.group.visible = visible;
  }

  show(message) {
    this.cloud.add(message);
    this.frames.group(message.frame_id).add(this.group);
  }

  touchable() {
    return [...this.cloud.keyframes.values()].map((object) => ({object, timeS: object.timeS}));
  }

  clear() {
    this.cloud.clear();
  }
}

/** The poses of the keyframes; also moves their clouds. */
class KeyframeLayer extends Layer {
  constructor(frames, cloud) {
    super(frames, drawKeyframes);
    this.cloud = cloud;
  }

  show(message) {
    super.show(message);
    this.cloud.move(message);
  }
}

/** The layers by topic, in the order of the list on the page, each with its name and the colour of its swatch (CSS; "ramp": coloured by height or age). `off`: initially hidden. `software`: there is no graphics card. */
export function makeLayers(frames, software) {
  const entities = () => new EntityLayer(frames);
  const layer = (draw, frame) => new Layer(frames, draw, frame);
  const cloud = new CloudLayer(frames, software);
  return new Map([
    ["scene/robot", {name: "robot", swatch: "#f28c1a", layer: new RobotLayer(frames)}],
    ["SCAN", {name: "laser fan", swatch: "#ff5252", layer: layer(drawScan)}],
    ["CLOUD", {name: "point cloud", swatch: "ramp", layer: cloud}],
    ["OCTOMAP", {name: "voxels", swatch: "ramp", layer: layer(drawVoxels(software ? 12000 : 200000)), off: true}],
    ["MAP_2D", {name: "2D map", swatch: "linear-gradient(to right, #5a697d 50%, #e62d2d 50%)", layer: layer(drawGrid(paintOccupancy))}],
    ["LOCAL_MAP", {name: "ground around the robot", swatch: "linear-gradient(to right, #46a06e 50%, #ff7828 50%)", layer: layer(drawGrid(paintGround, 0.005)), off: true}],
    ["OBSTACLE_MAP", {name: "obstacle map", swatch: "#ffb74d", layer: layer(drawPoints(0xffb74d, 5))}],
    ["STRUCTURE_MAP", {name: "structure map", swatch: "#4dd0e1", layer: layer(drawPoints(0x4dd0e1, 5))}],
    ["scene/corridor", {name: "virtual corridor", swatch: "#1ab34d", layer: entities()}],
    ["scene/area_of_interest", {name: "area of interest", swatch: "#4db3ff", layer: entities()}],
    // Drawn from the common start, not in the present odom frame, so that the trails can be compared.
    ["trail/odometry", {name: "odometry trail", swatch: "#ff8fd0", layer: layer(drawTrail(0xff8fd0), "map")}],
    ["trail/2d", {name: "2D SLAM trail", swatch: "#5fb3ff", layer: layer(drawTrail(0x5fb3ff))}],
    ["trail/6d", {name: "6D SLAM trail", swatch: "#ffe082", layer: layer(drawTrail(0xffe082))}],
    ["keyframes", {name: "keyframes", swatch: "radial-gradient(circle, #ffe082 45%, transparent 50%)", layer: new KeyframeLayer(frames, cloud.cloud)}],
    ["scene/path", {name: "path", swatch: "#1acc4d", layer: entities()}],
    ["scene/tracks", {name: "tracks of people", swatch: "#ff8c1a", layer: entities()}],
    ["scene/exploration", {name: "exploration", swatch: "linear-gradient(to right, #ff4de6 50%, #bf8cff 50%)", layer: entities()}],
    ["scene/pose_graph", {name: "pose graph", swatch: "linear-gradient(to right, #5fb3ff 50%, #66e680 50%)", layer: entities(), off: true}],
    ["scene/pose_graph_6d", {name: "6D pose graph", swatch: "linear-gradient(to right, #5fb3ff 50%, #66e680 50%)", layer: entities(), off: true}],
    ["scene/goal", {name: "goal", swatch: "#1acc4d", layer: entities()}],
    ["scene/people", {name: "people (ground truth)", swatch: "#d9339a", layer: entities()}],
  ]);
}
