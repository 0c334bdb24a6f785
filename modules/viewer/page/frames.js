// SPDX-License-Identifier: BSD-3-Clause
// The tree of frames, as groups of the scene: objects in a frame's group are drawn in that frame.
import {Group, Matrix4, Quaternion, Vector3} from "./three/build/three.module.js";

/** Sets position and orientation of an object of the scene from a Foxglove pose. */
export function setPose(object, pose) {
  object.position.set(pose.position.x, pose.position.y, pose.position.z);
  object.quaternion.set(pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w);
}

/** Keeps the pose of each frame's group in the root frame, which is the frame without a parent. */
export class Frames {
  constructor(scene) {
    this.scene = scene;
    this.groups = new Map();
    this.links = new Map();  // child -> {parent, matrix}
  }

  group(frame) {
    if (!this.groups.has(frame)) {
      const group = new Group();
      group.name = frame;
      group.matrixAutoUpdate = false;
      this.groups.set(frame, group);
      this.scene.add(group);
    }
    return this.groups.get(frame);
  }

  /** A foxglove.FrameTransform. */
  set(transform) {
    const {translation: t, rotation: r} = transform;
    const matrix = new Matrix4().compose(
        new Vector3(t.x, t.y, t.z), new Quaternion(r.x, r.y, r.z, r.w), new Vector3(1, 1, 1));
    this.links.set(transform.child_frame_id, {parent: transform.parent_frame_id, matrix});
    this.group(transform.child_frame_id);
    this.group(transform.parent_frame_id);
    this.update();
  }

  /** The transform from a frame to the root of its tree. */
  matrixOf(frame) {
    const matrix = new Matrix4();
    for (let link = this.links.get(frame), depth = 0; link && depth < 8; link = this.links.get(link.parent), ++depth) {
      matrix.premultiply(link.matrix);
    }
    return matrix;
  }

  update() {
    for (const [frame, group] of this.groups) {
      group.matrix.copy(this.matrixOf(frame));
      group.matrixWorldNeedsUpdate = true;
    }
  }

  clear() {
    this.links.clear();
    this.update();
  }
}
