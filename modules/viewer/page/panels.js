// SPDX-License-Identifier: BSD-3-Clause
// The state of the robot in words: banner, facts, processes.

const STALE_S = 2;
// What processes say of themselves, this one among them: no sign that the robot is there.
const NO_DATA = new Set(["STATUS", "log"]);
const QUALITY = ["tracked", "partly tracked", "by odometry only", "LOST"];
const LOST = 3;
const HEALTH = ["OK", "DEGRADED", "FAILED"];
const DEGREES = 180 / Math.PI;

function element(tag, text, attributes = {}) {
  const node = document.createElement(tag);
  node.textContent = text;
  Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
  return node;
}

/** The processes, newest report of each. */
export function showProcesses(body, processes) {
  body.replaceChildren(...processes.map((p) => {
    const row = document.createElement("tr");
    const state = element("td", HEALTH[p.health] ?? "unknown", {"data-health": p.health});
    if (p.health_reason) {
      state.append(element("small", p.health_reason));
    }
    row.append(element("th", p.process_name, {scope: "row"}), state, element("td", (p.handled_per_s ?? 0).toFixed(0)),
        element("td", ((p.latency_p99_us ?? 0) / 1000).toFixed(1)), element("td", p.total_lost));
    return row;
  }));
}

/** Keeps what is known of the robot, and says it. */
export class State {
  constructor({banner, summary, facts}) {
    Object.assign(this, {banner, summary, facts});
    this.processes = [];
    this.clear();
  }

  clear() {
    this.latest = {};
    this.lastDataMs = null;
  }

  note(topic, message) {
    this.latest[topic] = message;
    if (!NO_DATA.has(topic)) {
      this.lastDataMs = performance.now();
    }
  }

  /** What is wrong, the worst first: [level, text], or null. `expectsData`: nothing is paused or at its end. */
  trouble(connected, expectsData) {
    if (!connected) {
      return ["error", "No connection to nodmap-viewer: what is shown is old."];
    }
    const silentS = this.lastDataMs === null ? Infinity : (performance.now() - this.lastDataMs) / 1000;
    if (expectsData && silentS > STALE_S) {
      return ["error", Number.isFinite(silentS) ? `No data for ${silentS.toFixed(0)} s: what is shown is old.` : "No data: nothing has come yet."];
    }
    for (const [topic, name] of [["POSE_2D", "2D SLAM"], ["POSE_6D", "6D SLAM"]]) {
      if (this.latest[topic]?.pose_quality === LOST) {
        return ["error", `LOST: ${name} does not know where the robot is.`];
      }
    }
    const ill = (this.latest.STATUS?.processes ?? []).filter((p) => p.health !== 0).sort((a, b) => b.health - a.health);
    return ill.length === 0 ? null :
      [ill[0].health === 2 ? "error" : "warning", ill.map((p) => `${p.process_name} ${HEALTH[p.health]}: ${p.health_reason}`).join(" · ")];
  }

  showBanner(connected, expectsData) {
    const trouble = this.trouble(connected, expectsData);
    const text = trouble ? trouble[1] : "";
    this.banner.hidden = !trouble;
    if (this.banner.textContent !== text) {
      this.banner.textContent = text;
      this.banner.dataset.level = trouble ? trouble[0] : "";
    }
  }

  showFacts(extra) {
    const {ODOMETRY: odometry, NAVIGATION: navigation, PITCH_STATE: pitch, POSE_2D: pose2d, POSE_6D: pose6d, TRUTH: truth} = this.latest;
    const number = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}` : "-");
    const at = (pose) => `x ${number(pose.position_m[0], 2, "m")}, y ${number(pose.position_m[1], 2, "m")}`;
    const facts = [["speed", number(odometry?.forward_mps, 2, "m/s")]];
    if (navigation) {
      facts.push(["behaviour", navigation.behaviour_name], ["bound", number(navigation.max_forward_mps, 2, "m/s")]);
    }
    if (pitch) {
      facts.push(["pitch", number(DEGREES * pitch.pitch_rad, 1, "°")]);
    }
    if (pose2d) {
      facts.push(["2D SLAM", `${at(pose2d)}, ${QUALITY[pose2d.pose_quality] ?? "unknown"}`]);
    }
    if (pose6d) {
      facts.push(["6D SLAM", `${at(pose6d)}, ${QUALITY[pose6d.pose_quality] ?? "unknown"}`]);
    }
    if (truth) {
      facts.push(["clearance", number(truth.clearance_m, 2, "m")], ["collisions", String(truth.collisions)]);
    }
    this.facts.replaceChildren(...[...facts, ...extra].flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
  }
}

/** A check box for each layer; keeps the choice in this browser. */
export function makeLayerList(fieldset, layers) {
  for (const [topic, {name, layer}] of layers) {
    const key = `layer:${topic}`;
    const box = document.createElement("input");
    box.type = "checkbox";
    box.dataset.topic = topic;
    box.checked = localStorage.getItem(key) !== "off";
    layer.group.visible = box.checked;
    box.addEventListener("change", () => {
      layer.group.visible = box.checked;
      localStorage.setItem(key, box.checked ? "on" : "off");
    });
    const label = element("label", "");
    label.append(box, ` ${name}`);
    fieldset.append(label);
  }
}
