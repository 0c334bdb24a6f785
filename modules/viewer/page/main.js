// SPDX-License-Identifier: BSD-3-Clause
// The page: messages in, images and texts out.
import {Connection, tokenIn} from "./connection.js";
import {confirmed} from "./confirm.js";
import {Control, keyOf} from "./control.js";
import {pointsOf} from "./decode.js";
import {Detail} from "./detail.js";
import {makeLayers} from "./layers.js";
import {applyCamera, isLink, makeLink, readLink} from "./link.js";
import {makeLayerList, makeLook, makeTheme} from "./look.js";
import {Output} from "./output.js";
import {Playback} from "./playback.js";
import {Plots} from "./plots.js";
import {tellOnClick} from "./probe.js";
import {Processes} from "./processes.js";
import {Results} from "./results.js";
import {Measuring, ScaleBar} from "./ruler.js";
import {View} from "./scene.js";
import {isSoftware} from "./splat.js";
import {State} from "./state.js";

const PLOT_MS = 100;
const WORDS_MS = 250;
const MAX_POSES = 2000;  // that the server's topic `keyframes` holds

const byId = (id) => document.getElementById(id);

const view = new View(byId("canvas"));
const software = !view.renderer || isSoftware(view.renderer.getContext());
byId("no-webgl").hidden = Boolean(view.renderer);
const layers = makeLayers(view.frames, software);
const {cloud} = layers.get("CLOUD").layer;
const detail = new Detail(software ? 100000 : 20000);
const plots = new Plots(byId("plots"));
const state = new State({banner: byId("banner"), announcement: byId("announcement"), facts: byId("facts")});
const playback = new Playback(byId("playback"), () => connection);
tellOnClick(view, layers, {
  isFree: () => view.clickMode === "none", timeText: (timeS) => playback.timeText(timeS), say: (text) => { byId("told").textContent = text; },
});
const control = new Control(byId("stop-bar"), byId("control"), view, () => connection);
const output = new Output(byId("output"), (command) => connection.call("control", {do: "process_output", command}));
const processes = new Processes(byId("processes").tBodies[0], askProcess, (command) => output.show(command));
new Results(byId("results"), () => state.processes, (command) => connection.call("control", {do: "process_output", command}));
const pending = new Map();  // the newest message of each topic since the last image
let keyframes = [];         // all keyframes that wait to be shown: {read, timeS}
let connected = false;
let received = 0;
let hasHistory = false;     // whether the plots show the recording's history

makeLayerList(byId("layers"), layers, () => view.touch());
makeLook({color: byId("color"), ceiling: byId("ceiling"), low: byId("low"), high: byId("high"), ramp: byId("ramp")}, () => view.touch());

makeTheme(byId("theme"), view);
const scaleBar = new ScaleBar(byId("scale-bar"), view);
const measuring = new Measuring(byId("measure"), view, (text) => { byId("measured").textContent = text; });

/** Starts, stops or restarts a process; asks first if this page would lose its server. */
async function askProcess(what, command, program) {
  const isOurs = program === "nodmap-viewer" && what !== "start";
  if (!isOurs || await confirmed(byId("confirm"), `Really ${what} the viewer? It serves this page and its STOP button; a new viewer prints a new address.`)) {
    control.ask({do: `${what}_process`, command});
  }
}

function forgetAll() {
  pending.clear();
  keyframes = [];
  layers.forEach(({layer}) => layer.clear());
  view.frames.clear();
  view.touch();
  plots.clear();
  state.clear();
}

/** The distance of the nearest point of an obstacle map from the robot; infinite without points. */
function nearestOf(map) {
  const points = pointsOf(map);
  let nearest = Infinity;
  for (let i = 0; i < points.length; i += 3) {
    nearest = Math.min(nearest, Math.hypot(points[i], points[i + 1]));
  }
  return nearest;
}

function take(topic, read, timeS) {
  ++received;
  state.noteArrival(topic);
  if (topic === "CLOUD") {
    keyframes.push({read, timeS});
  } else {
    pending.set(topic, {read, timeS, keyframesBefore: keyframes.length});
  }
}

/** Drops what waits of another map: keyframes that arrived before this message, as `count` did, and are not in it. */
function dropOtherMap({times}, count) {
  if (times.length >= MAX_POSES) {
    return;  // it names the newest ones only
  }
  const microseconds = (timeS) => Math.round(1e6 * timeS);
  const known = new Set(times.map(({sec, nsec}) => microseconds(sec + 1e-9 * nsec)));
  keyframes = keyframes.filter(({timeS}, i) => i >= count || known.has(microseconds(timeS)));
}

/** Draws a message received since the last image; messages that were replaced meanwhile cost nothing. */
function show(topic, {read, timeS, keyframesBefore}) {
  const message = read();
  state.note(topic, message);
  if (topic.startsWith("tf/")) {
    view.frames.set(message);
    view.touch();
  } else if (topic === "STATUS" || topic === "PM_INFO") {
    processes.show(state.processes);
  } else if (topic === "stop_state") {
    control.showStopped(message.state !== "RELEASED");
  } else if (layers.has(topic)) {
    layers.get(topic).layer.show(message);
    view.touch();
  }
  if (topic === "keyframes") {
    dropOtherMap(message, keyframesBefore);
  }
  plots.add(topic, message, timeS, topic === "OBSTACLE_MAP" ? nearestOf(message) : undefined);
}

const connection = new Connection({
  open(info) {
    connected = true;
    byId("token-refused").hidden = true;  // a single failed attempt says little
    hasHistory = false;
    cloud.maxPoints = Number(info.metadata.max_cloud_points);
    plots.gaps = {steady: Number(info.metadata.gap_s), status: Number(info.metadata.status_gap_s)};
    plots.follow();
    forgetAll();
    playback.open(info);
    byId("summary").textContent = `Connected to ${info.name}.`;
    connection.send({op: "subscribeParameterUpdates", parameterNames: []});
    connection.send({op: "getParameters", parameterNames: [], id: "page"});
    processes.canControl = control.open(info);
  },
  services() {
    control.sendStop();
  },
  tokenRefused() {
    byId("token-refused").hidden = false;
  },
  close() {
    connected = false;
    byId("summary").textContent = "Not connected.";
  },
  message: take,
  time(timeS) {
    if (playback.onTime(timeS)) {
      forgetAll();
    }
  },
  parameters(values) {
    playback.set(values);
    if (playback.durationS > 0 && !hasHistory) {
      hasHistory = true;
      showHistory();
    }
  },
});

/** Lets the plots show a whole recording. */
async function showHistory() {
  const history = await fetch("history.json").then((answer) => answer.json());
  plots.showHistory(history, playback.beginS, playback.durationS);
}

byId("read-only").addEventListener("click", () => {
  byId("token-refused").hidden = true;
  history.replaceState(null, "", location.pathname);
  connection.token = null;
});

/** Sets camera and time from the page's address, also when it was edited. */
function followLink() {
  const link = readLink(location.hash);
  applyCamera(view, link);
  showMode();
  playback.wantedS = link.timeS;
}
function showMode() {
  document.querySelectorAll("[data-camera]").forEach((button) => button.setAttribute("aria-pressed", button.dataset.camera === view.mode));
}
window.addEventListener("hashchange", () => {
  const token = tokenIn(location.hash);
  if (token && token !== connection.token) {
    location.reload();  // a browser does not load an address again of which only the part after '#' is new
    return;
  }
  followLink();
  playback.seekWanted();
});
if (isLink(location.hash)) {
  followLink();
}
byId("link").addEventListener("click", () => {
  const link = makeLink(location, view, playback.positionS);
  history.replaceState(null, "", link);
  navigator.clipboard?.writeText(link).catch(() => {});  // it is also in the address
});

// Single letters, because no field of the page takes any. Dialogs are not modal, so that STOP can still be pressed.
const keys = {
  "?": () => byId("help").show(),
  escape: () => document.querySelector("dialog[open]")?.close(),
  m: () => byId("measure").click(),
  f: () => document.querySelector("[data-camera=follow]").click(),
  t: () => document.querySelector("[data-camera=top]").click(),
  r: () => document.querySelector("[data-camera=free]").click(),
};
document.addEventListener("keydown", (event) => {
  if (!event.ctrlKey && !event.altKey && !event.metaKey && !event.target.closest?.("select")) {
    keys[keyOf(event)]?.();
  }
});
byId("help-open").addEventListener("click", keys["?"]);

document.querySelectorAll("[data-camera]").forEach((button) => button.addEventListener("click", () => {
  view.setMode(button.dataset.camera);
  showMode();
}));

function onFrame(nowMs) {
  requestAnimationFrame(onFrame);
  pending.forEach((value, topic) => show(topic, value));
  pending.clear();
  if (keyframes.length > 0) {
    layers.get("CLOUD").layer.show(keyframes.shift().read());  // one per image, so that a long history does not block the view
    view.touch();
  }
  if (detail.step(nowMs, view.update(), cloud.total)) {
    cloud.distribute(detail.budget);
    view.render();
    scaleBar.update();
  }
}
requestAnimationFrame(onFrame);

setInterval(() => {
  state.showBanner(connected, playback.isRunning);
  state.showFacts([["points", `${cloud.drawn} of ${cloud.total}`], ["drawn", `${(1000 / detail.frameMs).toFixed(0)} per s`]]);
}, WORDS_MS);
setInterval(() => {
  plots.draw();
  plots.showCursor(playback.beginS + playback.positionS);
}, PLOT_MS);

// The content of the page as numbers, for tests and for the images in the documentation.
window.nodmap = {
  connection, view, layers, cloud, detail, playback, plots, measuring, received: () => received,
  take: (topic, message, timeS) => take(topic, () => message, timeS),
};
