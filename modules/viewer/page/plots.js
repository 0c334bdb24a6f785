// SPDX-License-Identifier: BSD-3-Clause
// A row of plots, drawn by dygraphs (a global, because Debian's package has no module). Live, they show the last minute; for a
// recording, all of it, with a cursor at the present time. Missing messages leave a gap.

import {element} from "./element.js";

const WINDOW_S = 60;
const DEGREES = 180 / Math.PI;
const SAMPLE_S = 0.1;
const COLORS = ["#5fb3ff", "#ffb74d", "#8bd17c", "#ff8fd0"];
// Processes whose latency is plotted: those that determine the robot's reaction time, and the two slow ones; with short names.
const TIMED = {"nodmap-map-server": "maps", "nodmap-navigator": "navigator", "nodmap-slam2d": "2D", "nodmap-slam6d": "6D"};

/** The plots: a caption, their lines (name, quantity in a recording's history, factor to the plot's unit), and for each topic what it adds to which line. */
const PLOTS = [
  {caption: "speed, m/s", lines: [["speed", "forward_mps", 1], ["speed bound", "max_forward_mps", 1]],
    from: {ODOMETRY: (m) => ({speed: m.forward_mps}), NAVIGATION: (m) => ({"speed bound": m.max_forward_mps})}},
  {caption: "pitch, °", lines: [["pitch", "pitch_rad", DEGREES]],
    from: {PITCH_STATE: (m) => ({pitch: DEGREES * m.pitch_rad}), SCAN: (m) => ({pitch: DEGREES * pitchOf(m.pose.orientation)})}},
  {caption: "sweep duration, s", lines: [["sweep", "sweep_s", 1]], from: {PITCH_COMMAND: (m) => ({sweep: m.sweep_s})}},
  {caption: "obstacles, m", lines: [["from centre", "nearest_m", 1], ["ahead of front", "clear_distance_m", 1]],
    from: {OBSTACLE_MAP: (m, extra) => ({"from centre": extra}), NAVIGATION: (m) => ({"ahead of front": m.clear_distance_m})}},
  {caption: "latency (p99), ms", lines: Object.entries(TIMED).map(([process, name]) => [name, `latency_p99_us ${process}`, 1e-3]), logscale: true,
    gap: "status", from: {STATUS: latenciesOf}},
];

/** The latencies in a STATUS, by process. A process that has handled nothing has none. */
function latenciesOf(status) {
  const timed = status.processes.filter((p) => p.process_name in TIMED && p.latency_p99_us > 0);
  return Object.fromEntries(timed.map((p) => [TIMED[p.process_name], p.latency_p99_us / 1000]));
}

/** The pitch of an orientation, radians; positive looks up. */
function pitchOf(q) {
  return Math.asin(Math.min(Math.max(2 * (q.x * q.z - q.w * q.y), -1), 1));
}

function shortNumber(value) {
  return String(Number(value.toPrecision(2)));
}

/** One plot; added to the page when it has something to show. */
class Plot {
  constructor(parent, {caption, lines, from, logscale = false, gap = "steady"}) {
    Object.assign(this, {lines, from, logscale, gap});
    this.samples = lines.map(() => []);  // for each line [seconds, value]; NaN where a gap begins
    this.window = null;                  // time window of a recording, seconds; null: the last minute
    this.figure = element("figure", "", {hidden: ""});
    this.box = element("div", "", {class: "plot", role: "img", "aria-label": `plot: ${caption}`});
    this.cursor = element("div", "", {class: "cursor", hidden: ""});
    this.names = element("span", "", {class: "lines", "aria-hidden": "true"});
    const title = element("figcaption", caption);
    title.append(this.names);
    const place = element("div", "", {class: "place"});
    place.append(this.box, this.cursor);
    this.figure.append(title, place);
    parent.append(this.figure);
  }

  /** Called with the first samples: dygraphs takes its size from its element, which must be on the page, and a log scale needs values. */
  open() {
    this.figure.hidden = false;
    this.graph = new Dygraph(this.box, this.rows(), {
      labels: ["time", ...this.lines.map(([name]) => name)], connectSeparatedPoints: true, legend: "always", labelsDiv: this.names, strokeWidth: 1.5,
      drawGrid: true, logscale: this.logscale, gridLineColor: "#2c343c", axisLineColor: "#39424c", colors: COLORS,
      axes: {x: {pixelsPerLabel: 70}, y: {axisLabelWidth: 34, axisLabelFormatter: shortNumber}}, interactionModel: {}, dateWindow: this.window,
    });
    new ResizeObserver(() => this.graph.resize()).observe(this.box);
  }

  /** A row of dygraphs' table for each sample: null if another line has a value there, NaN where the line is interrupted. */
  rows() {
    const all = this.samples.flatMap((samples, line) => samples.map(([timeS, value]) => ({timeS, value, line})));
    return all.sort((a, b) => a.timeS - b.timeS).map(({timeS, value, line}) => {
      const row = [new Date(1000 * timeS), ...this.lines.map(() => null)];
      row[1 + line] = value;
      return row;
    });
  }

  add(topic, message, timeS, extra, gaps) {
    if (this.window || !(topic in this.from)) {
      return;
    }
    for (const [name, value] of Object.entries(this.from[topic](message, extra))) {
      this.addSample(this.samples[this.lines.findIndex(([line]) => line === name)], timeS, value, gaps[this.gap]);
    }
    this.samples.forEach((samples) => {
      while (samples.length && timeS - samples[0][0] > WINDOW_S) {
        samples.shift();
      }
    });
  }

  addSample(samples, timeS, value, gapS) {
    if (samples.length && timeS < samples[samples.length - 1][0] - gapS) {
      // The clock was set back; a message that is only a little older than the last one came by a longer way.
      this.samples.forEach((line) => { line.length = 0; });
    }
    const lastS = samples.length ? samples[samples.length - 1][0] : -Infinity;
    if (!Number.isFinite(value) || timeS - lastS < SAMPLE_S) {
      return;
    }
    if (timeS - lastS > gapS && samples.length) {
      samples.push([lastS, NaN]);
    }
    samples.push([timeS, value]);
    this.changed = true;
  }

  /** Shows a recording's history: {quantity: [[seconds, value or null]]}. */
  showHistory(history, beginS, durationS) {
    this.samples = this.lines.map(([, quantity, factor]) => (history[quantity] ?? []).map(([timeS, value]) => [timeS, value === null ? NaN : factor * value]));
    this.window = [1000 * beginS, 1000 * (beginS + durationS)];
    this.graph?.updateOptions({dateWindow: this.window});
    this.changed = true;
  }

  showCursor(timeS) {
    if (this.graph) {
      this.cursor.hidden = !this.window;
      this.cursor.style.left = `${this.graph.toDomXCoord(new Date(1000 * timeS))}px`;
    }
  }

  clear() {
    if (!this.window) {
      this.samples = this.lines.map(() => []);
    }
  }

  /** Shows the last minute from now on. */
  follow() {
    this.window = null;
    this.cursor.hidden = true;
    this.graph?.updateOptions({dateWindow: null});
    this.clear();
  }

  draw() {
    if (!this.changed || !this.samples.some((samples) => samples.length > 1)) {
      return;
    }
    this.changed = false;
    if (this.graph) {
      this.graph.updateOptions({file: this.rows()});
    } else {
      this.open();
    }
  }
}

export class Plots {
  constructor(parent) {
    this.plots = PLOTS.map((description) => new Plot(parent, description));
    this.gaps = {};  // longest time between messages without a gap, seconds, as the server has it in a recording's history: of STATUS, and of all others
    this.next = 0;
  }

  /** `extra`: a value already computed from the message, the nearest obstacle. */
  add(topic, message, timeS, extra) {
    this.plots.forEach((plot) => plot.add(topic, message, timeS, extra, this.gaps));
  }

  /** Shows a whole recording, independent of the playback. */
  showHistory(history, beginS, durationS) {
    this.plots.forEach((plot) => plot.showHistory(history, beginS, durationS));
  }

  showCursor(timeS) {
    this.plots.forEach((plot) => plot.showCursor(timeS));
  }

  follow() {
    this.plots.forEach((plot) => plot.follow());
  }

  /** Draws the next plot; drawing all at once would be noticeable. */
  draw() {
    this.plots[this.next].draw();
    this.next = (this.next + 1) % this.plots.length;
  }

  clear() {
    this.plots.forEach((plot) => plot.clear());
  }
}
