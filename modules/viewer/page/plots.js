// SPDX-License-Identifier: BSD-3-Clause
// A strip of plots over the last minute, by dygraphs (a global: Debian's package has no module of it).

import {element} from "./element.js";

const WINDOW_S = 60;
const DEGREES = 180 / Math.PI;
const SAMPLE_S = 0.1;
const COLORS = ["#5fb3ff", "#ffb74d", "#8bd17c", "#ff8fd0"];
// Those whose time the robot's reaction depends on, and the two that take long; with short names.
const TIMED = {"nodmap-map-server": "maps", "nodmap-navigator": "navigator", "nodmap-slam2d": "2D", "nodmap-slam6d": "6D"};

/** The plots: a caption, the names of their lines, and for each topic what it adds to which line. */
const PLOTS = [
  {caption: "speed, m/s", lines: ["speed", "bound"],
    from: {ODOMETRY: (m) => ({speed: m.forward_mps}), NAVIGATION: (m) => ({bound: m.max_forward_mps})}},
  {caption: "pitch, °", lines: ["pitch"],
    from: {PITCH_STATE: (m) => ({pitch: DEGREES * m.pitch_rad}), SCAN: (m) => ({pitch: DEGREES * pitchOf(m.pose.orientation)})}},
  {caption: "sweep time, s", lines: ["sweep"], from: {PITCH_COMMAND: (m) => ({sweep: m.sweep_s})}},
  {caption: "obstacles, m", lines: ["nearest", "clear distance"],
    from: {OBSTACLE_MAP: (m, extra) => ({nearest: extra}), NAVIGATION: (m) => ({"clear distance": m.clear_distance_m})}},
  {caption: "latency (p99), ms", lines: Object.values(TIMED), logscale: true, from: {STATUS: latenciesOf}},
];

/** The latencies of a STATUS, by process. A process that has handled nothing has none. */
function latenciesOf(status) {
  const timed = status.processes.filter((p) => p.process_name in TIMED);
  return Object.fromEntries(timed.map((p) => [TIMED[p.process_name], p.latency_p99_us > 0 ? p.latency_p99_us / 1000 : null]));
}

/** How far up the x axis of an orientation looks, radians. */
export function pitchOf(q) {
  return Math.asin(Math.min(Math.max(2 * (q.x * q.z - q.w * q.y), -1), 1));
}

function shortNumber(value) {
  return String(Number(value.toPrecision(2)));
}

/** One plot; not on the page before it has something to show. */
class Plot {
  constructor(parent, {caption, lines, from, logscale = false}) {
    Object.assign(this, {lines, from, logscale});
    this.rows = [];
    this.newest = lines.map(() => null);
    this.figure = element("figure", "", {hidden: ""});
    this.box = element("div", "", {class: "plot", role: "img", "aria-label": `plot: ${caption}`});
    this.names = element("span", "", {class: "lines", "aria-hidden": "true"});
    const title = element("figcaption", caption);
    title.append(this.names);
    this.figure.append(title, this.box);
    parent.append(this.figure);
  }

  /** With the first rows: dygraphs takes its size from its box, which is on the page by now, and a log scale needs values. */
  open() {
    this.figure.hidden = false;
    this.graph = new Dygraph(this.box, this.rows, {
      labels: ["time", ...this.lines], connectSeparatedPoints: true, legend: "always", labelsDiv: this.names, strokeWidth: 1.5, drawGrid: true,
      logscale: this.logscale, gridLineColor: "#2c343c", axisLineColor: "#39424c", colors: COLORS,
      axes: {x: {pixelsPerLabel: 70}, y: {axisLabelWidth: 34, axisLabelFormatter: shortNumber}}, interactionModel: {},
    });
    new ResizeObserver(() => this.graph.resize()).observe(this.box);
  }

  add(topic, message, timeS, extra) {
    if (!(topic in this.from)) {
      return;
    }
    for (const [line, value] of Object.entries(this.from[topic](message, extra))) {
      this.newest[this.lines.indexOf(line)] = Number.isFinite(value) ? value : null;
    }
    const last = this.rows[this.rows.length - 1];
    if (this.newest.some((value) => value !== null) && (!last || timeS - last[0].getTime() / 1000 >= SAMPLE_S)) {
      this.rows.push([new Date(1000 * timeS), ...this.newest]);
      this.changed = true;
    }
    while (this.rows.length && timeS - this.rows[0][0].getTime() / 1000 > WINDOW_S) {
      this.rows.shift();
    }
  }

  clear() {
    this.rows = [];
    this.newest.fill(null);
  }

  draw() {
    if (!this.changed || this.rows.length < 2) {
      return;
    }
    this.changed = false;
    if (this.graph) {
      this.graph.updateOptions({file: this.rows});
    } else {
      this.open();
    }
  }
}

export class Plots {
  constructor(parent) {
    this.plots = PLOTS.map((description) => new Plot(parent, description));
    this.next = 0;
  }

  /** `extra` is what has been worked out of the message already: the nearest obstacle. */
  add(topic, message, timeS, extra) {
    this.plots.forEach((plot) => plot.add(topic, message, timeS, extra));
  }

  /** Draws the next of them: all at once would be felt. */
  draw() {
    this.plots[this.next].draw();
    this.next = (this.next + 1) % this.plots.length;
  }

  clear() {
    this.plots.forEach((plot) => plot.clear());
  }
}
