// SPDX-License-Identifier: BSD-3-Clause
// A strip of plots over the last minute, by dygraphs (a global: Debian's package has no module of it).

const WINDOW_S = 60;
const DEGREES = 180 / Math.PI;
const SAMPLE_S = 0.1;

/** The plots: a caption, the names of their lines, and for each topic what it adds to which line. */
const PLOTS = [
  {caption: "speed and its bound, m/s", lines: ["speed", "bound"],
    from: {ODOMETRY: (m) => ({speed: m.forward_mps}), NAVIGATION: (m) => ({bound: m.max_forward_mps})}},
  {caption: "pitch, degrees", lines: ["pitch"],
    from: {PITCH_STATE: (m) => ({pitch: DEGREES * m.pitch_rad}), SCAN: (m) => ({pitch: DEGREES * pitchOf(m.pose.orientation)})}},
  {caption: "sweep time, s", lines: ["sweep"], from: {PITCH_COMMAND: (m) => ({sweep: m.sweep_s})}},
  {caption: "nearest obstacle and free way, m", lines: ["nearest", "free way"],
    from: {OBSTACLE_MAP: (m, extra) => ({nearest: extra}), NAVIGATION: (m) => ({"free way": m.free_way_m})}},
  {caption: "slowest process, p99 ms", lines: ["p99"],
    from: {STATUS: (m) => ({p99: Math.max(...m.processes.map((p) => p.latency_p99_us)) / 1000})}},
];

/** How far up the x axis of an orientation looks, radians. */
export function pitchOf(q) {
  return Math.asin(Math.min(Math.max(2 * (q.x * q.z - q.w * q.y), -1), 1));
}

class Plot {
  constructor(parent, {caption, lines, from}) {
    this.lines = lines;
    this.from = from;
    this.rows = [];
    this.newest = lines.map(() => null);
    const figure = document.createElement("figure");
    const title = document.createElement("figcaption");
    title.textContent = caption;
    const box = document.createElement("div");
    box.className = "plot";
    box.setAttribute("role", "img");
    box.setAttribute("aria-label", `plot: ${caption}`);
    figure.append(title, box);
    parent.append(figure);
    this.box = box;
  }

  /** When all boxes are in their places: dygraphs takes its size from its box. */
  open() {
    this.graph = new Dygraph(this.box, [[new Date(0), ...this.newest]], {
      labels: ["time", ...this.lines], connectSeparatedPoints: true, legend: "always", strokeWidth: 1.5, drawGrid: true, gridLineColor: "#2c343c",
      axisLineColor: "#39424c", axes: {x: {pixelsPerLabel: 70}, y: {axisLabelWidth: 34}}, interactionModel: {},
      colors: ["#5fb3ff", "#ffb74d"],
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
    if (!last || timeS - last[0].getTime() / 1000 >= SAMPLE_S) {
      this.rows.push([new Date(1000 * timeS), ...this.newest]);
      this.changed = true;
    }
    while (this.rows.length && timeS - this.rows[0][0].getTime() / 1000 > WINDOW_S) {
      this.rows.shift();
    }
  }

  draw() {
    if (this.changed && this.rows.length > 1) {
      this.changed = false;
      this.graph.updateOptions({file: this.rows});
    }
  }
}

export class Plots {
  constructor(parent) {
    this.plots = PLOTS.map((description) => new Plot(parent, description));
    this.plots.forEach((plot) => plot.open());
  }

  /** `extra` is what has been worked out of the message already: the nearest obstacle. */
  add(topic, message, timeS, extra) {
    this.plots.forEach((plot) => plot.add(topic, message, timeS, extra));
  }

  draw() {
    this.plots.forEach((plot) => plot.draw());
  }

  clear() {
    this.plots.forEach((plot) => { plot.rows = []; });
  }
}
