// SPDX-License-Identifier: BSD-3-Clause
// A link to what is seen: the camera, and the time of a recording. It stands behind '#', so that it is sent to nobody.

const KEYS = ["t", "camera"];

/** {timeS, position, target} of an address; each undefined where it is not in it or is nonsense. */
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

/** The address of this view. Never the token: a link is for others. */
export function makeLink({origin, pathname}, {camera, controls}, timeS) {
  const values = new URLSearchParams();
  if (timeS !== undefined) {
    values.set("t", timeS.toFixed(2));
  }
  values.set("camera", [...camera.position.toArray(), ...controls.target.toArray()].map((value) => value.toFixed(2)).join(","));
  return `${origin}${pathname}#${values.toString().replaceAll("%2C", ",")}`;
}

/** Looks as a link says. */
export function applyCamera(view, {position, target}) {
  if (position && target) {
    view.setMode("free");
    view.camera.position.fromArray(position);
    view.controls.target.fromArray(target);
    view.touch();
  }
}

/** Whether an address holds a link. */
export function isLink(hash) {
  const values = new URLSearchParams(hash.replace(/^#/, ""));
  return KEYS.some((key) => values.has(key));
}
