// SPDX-License-Identifier: BSD-3-Clause
// A link to the present view: the camera, and the time of a recording. It is after '#', so that browsers do not send it.

const KEYS = ["t", "camera"];

/** Reads {timeS, position, target} from an address; each is undefined if it is missing or invalid. */
export function readLink(hash) {
  const values = new URLSearchParams(hash.replace(/^#/, ""));
  const timeS = Number(values.get("t") ?? NaN);
  const numbers = (values.get("camera") ?? "").split(",").map(Number);
  const hasCamera = numbers.length === 6 && numbers.every(Number.isFinite);
  return {
    timeS: Number.isFinite(timeS) && timeS >= 0 ? timeS : undefined,
    position: hasCamera ? numbers.slice(0, 3) : undefined,
    target: hasCamera ? numbers.slice(3) : undefined,
  };
}

/** The address of this view, without the token, because links are passed on. */
export function makeLink({origin, pathname}, {camera, controls}, timeS) {
  const values = new URLSearchParams();
  if (timeS !== undefined) {
    values.set("t", timeS.toFixed(2));
  }
  values.set("camera", [...camera.position.toArray(), ...controls.target.toArray()].map((value) => value.toFixed(2)).join(","));
  return `${origin}${pathname}#${values.toString().replaceAll("%2C", ",")}`;
}

/** Sets the camera as in a link. */
export function applyCamera(view, {position, target}) {
  if (position && target) {
    view.setMode("free");
    view.camera.position.fromArray(position);
    view.controls.target.fromArray(target);
    view.touch();
  }
}

/** Whether an address contains a link. */
export function isLink(hash) {
  const values = new URLSearchParams(hash.replace(/^#/, ""));
  return KEYS.some((key) => values.has(key));
}
