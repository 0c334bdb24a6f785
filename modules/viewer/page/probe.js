// SPDX-License-Identifier: BSD-3-Clause
// Reports what is at the clicked point of the scene: its layer, coordinates, and time.
import {Raycaster, Vector2, Vector3} from "./three/build/three.module.js";
import {shared} from "./colors.js";

const REACH_M = 0.06;  // greatest distance of a point from the line of sight
// A point this little behind a surface takes precedence over the surface.
const POINTS_FIRST_M = 0.1;

/** The nearest visible object at a point of the canvas: {name, at, timeS}; null if there is none. */
function whatIsAt(event, view, layers) {
  const box = view.canvas.getBoundingClientRect();
  const ray = new Raycaster();
  ray.params.Points.threshold = REACH_M;
  ray.setFromCamera(new Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height), view.camera);
  let nearest = null;
  for (const {name, layer} of layers.values()) {
    for (const {object, timeS} of layer.group.visible ? layer.touchable() : []) {
      const hits = [];
      object.raycast(ray, hits);
      for (const hit of hits) {
        const at = object.isPoints ? placeOf(object, hit.index) : hit.point;
        const distance = hit.distance - (object.isPoints ? POINTS_FIRST_M : 0);
        if (at.z <= shared.ceilingM.value && (!nearest || distance < nearest.distance)) {
          nearest = {name, at, timeS, distance};
        }
      }
    }
  }
  return nearest;
}

function placeOf(points, index) {
  return new Vector3().fromBufferAttribute(points.geometry.attributes.position, index).applyMatrix4(points.matrixWorld);
}

/** Reports it at each click with `say(text)`. `isFree()`: the click has no other purpose. `timeText(seconds)`: a time as text. */
export function tellOnClick(view, layers, {isFree, timeText, say}) {
  view.onClick((event) => {
    if (!isFree()) {
      return;
    }
    const what = whatIsAt(event, view, layers);
    const at = what?.at ?? view.floorAt(event);
    const seen = what?.timeS ? `, seen ${timeText(what.timeS)}` : "";
    say(at ? `${what?.name ?? "floor"}: x ${at.x.toFixed(2)}, y ${at.y.toFixed(2)}, z ${at.z.toFixed(2)} m${seen}` : "");
  });
}
