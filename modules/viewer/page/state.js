// SPDX-License-Identifier: BSD-3-Clause
// The state of the robot as text: faults (the banner), and facts.
import {element} from "./element.js";
import {processList} from "./processes.js";

const STALE_S = 2;
// Channels about processes, including the viewer; they do not show that the robot is there.
const NO_DATA = new Set(["STATUS", "PM_INFO", "STOP", "stop_state", "log"]);
const DEGREES = 180 / Math.PI;
const LEVELS = ["note", "warning", "error"];

/** What the banner says while the robot is to be stopped: {level, what, why}; nothing after a release. */
export function stopFault({state, by}) {
  return {
    SENT: {level: 1, what: "STOP sent", why: `by ${by}; the base driver has not confirmed it yet`},
    STOPPED: {level: 1, what: "STOPPED", why: `by ${by}, until it is released`},
    NOT_CONFIRMED: {level: 2, what: "STOP not confirmed", why: `by ${by}; no base driver says that the robot is stopped`},
  }[state];
}

/** The goal, or that there is none, and whether the navigator reports on it. */
export function goalText(goal, navigation) {
  const isTaken = navigation?.goal_utime === (goal.is_active ? goal.utime : 0);
  if (!goal.is_active) {
    return isTaken ? "none: the robot roams" : "cancelled, not taken";
  }
  const [x, y] = goal.position_m;
  const state = navigation?.behaviour_name === "ARRIVED" ? "reached" : "taken";
  return `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m, ${isTaken ? state : "not taken"}`;
}

/** Keeps the newest data about the robot, and displays them as text. */
export class State {
  constructor({banner, announcement, facts}) {
    Object.assign(this, {banner, announcement, facts});
    this.clear();
  }

  clear() {
    this.latest = {};
    this.lastData = null;
  }

  /** Notes that a message has arrived. */
  noteArrival(topic) {
    if (!NO_DATA.has(topic)) {
      this.lastData = Date.now();
    }
  }

  note(topic, message) {
    this.latest[topic] = message;
  }

  get processes() {
    return processList(this.latest.STATUS?.processes ?? [], this.latest.PM_INFO?.commands ?? []);
  }

  /** All faults, the worst first: {level, what, why}. `expectsData`: the playback is not paused or at its end. */
  faults(connected, expectsData) {
    if (!connected) {
      return [{level: 2, what: "No connection to nodmap-viewer", why: "the display is out of date"}];
    }
    const faults = [];
    if (expectsData && this.lastData === null) {
      faults.push({level: 2, what: "No data", why: "nothing received yet"});
    } else if (expectsData && Date.now() - this.lastData > 1000 * STALE_S) {
      faults.push({level: 2, what: "No data", why: `since ${new Date(this.lastData).toLocaleTimeString()}: the display is out of date`});
    }
    for (const [topic, name] of [["POSE_2D", "2D SLAM"], ["POSE_6D", "6D SLAM"]]) {
      if (this.latest[topic]?.state_name === "LOST") {
        faults.push({level: 2, what: "LOST", why: `${name} does not know where the robot is`});
      }
    }
    faults.push(...[stopFault(this.latest.stop_state ?? {})].filter(Boolean));
    this.processes.filter(({level}) => level > 0).forEach(({name, state, level, reason}) => {
      faults.push({level, what: `${name} ${state}`, why: reason});
    });
    return faults.sort((a, b) => b.level - a.level);
  }

  showBanner(connected, expectsData) {
    const faults = this.faults(connected, expectsData);
    this.banner.hidden = faults.length === 0;
    this.banner.dataset.level = LEVELS[faults[0]?.level ?? 0];
    this.say(this.banner, faults.map(({what, why}) => (why ? `${what}: ${why}` : what)).join(" · "));
    this.say(this.announcement, faults.map(({what}) => what).join(", "));
  }

  /** Writes only changed texts, because a screen reader speaks at each change. */
  say(where, text) {
    if (where.textContent !== text) {
      where.textContent = text;
    }
  }

  showFacts(extra) {
    const {ODOMETRY: odometry, GOAL: goal, NAVIGATION: navigation, EXPLORATION: exploration, PITCH_STATE: pitch, POSE_2D: pose2d, POSE_6D: pose6d, TRUTH: truth} = this.latest;
    const number = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}` : "-");
    const at = (pose) => `x ${number(pose.position_m[0], 2, "m")}, y ${number(pose.position_m[1], 2, "m")}`;
    const facts = [["speed", number(odometry?.forward_mps, 2, "m/s")]];
    if (navigation) {
      facts.push(["behaviour", navigation.behaviour_name]);
      if (navigation.reason) {
        facts.push(["because", navigation.reason]);
      }
      facts.push(["speed bound", number(navigation.max_forward_mps, 2, "m/s")]);
    }
    if (goal) {
      facts.push(["goal", goalText(goal, navigation)]);
    }
    if (exploration) {
      facts.push(["exploration", `${exploration.state_name}, ${number(exploration.seen_m2, 0, "m²")} seen. ${exploration.reason}`.trim()]);
    }
    if (pitch) {
      facts.push(["pitch", number(DEGREES * pitch.pitch_rad, 1, "°")]);
    }
    if (pose2d) {
      facts.push(["2D SLAM", `${at(pose2d)}, ${pose2d.state_name}`]);
    }
    if (pose6d) {
      facts.push(["6D SLAM", `${at(pose6d)}, ${pose6d.state_name}`]);
    }
    if (truth) {
      facts.push(["ground truth", `clearance ${number(truth.clearance_m, 2, "m")}, collisions ${truth.collisions}`]);  // of a simulation
    }
    this.facts.replaceChildren(...[...facts, ...extra].flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
  }
}
