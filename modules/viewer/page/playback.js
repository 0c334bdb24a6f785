// SPDX-License-Identifier: BSD-3-Clause
// Pause, time line and speed of a recording.

import {element} from "./element.js";

const STEP_S = 0.1;
const LEAD_S = 1;  // start this long before an event
// After a seek, positions from before it may still arrive; they are ignored, for at most this long.
const SEEK_MS = 2000;
const SEEK_TOLERANCE_S = 0.5 * STEP_S;

function clockText(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

export class Playback {
  constructor(form, connection) {
    this.form = form;
    this.connection = connection;
    this.pause = form.querySelector("#pause");
    this.position = form.querySelector("#position");
    this.clock = form.querySelector("#clock");
    this.speed = form.querySelector("#speed");
    this.marks = form.querySelector("#marks");
    this.dragging = false;
    this.end();
    this.pause.addEventListener("click", () => this.toggle());
    this.speed.addEventListener("change", () => connection().setParameter("playback.speed", Number(this.speed.value)));
    this.position.addEventListener("pointerdown", () => { this.dragging = true; });
    document.addEventListener("pointerup", () => { this.dragging = false; });
    document.addEventListener("pointercancel", () => { this.dragging = false; });
    this.position.addEventListener("change", () => this.seek(Number(this.position.value)));
    document.addEventListener("keydown", (event) => this.onKey(event));
  }

  /** Takes a new connection, to a server that may play another recording, or none. */
  open({capabilities}) {
    this.marks.replaceChildren();
    if (!capabilities.includes("parameters")) {
      this.end();
    }
  }

  /** Forgets the recording, also that it was paused: a live robot that sends nothing is a fault. */
  end() {
    this.form.hidden = true;
    this.durationS = 0;
    this.positionS = 0;
    this.paused = false;
    this.beginS = undefined;  // the time at the begin of the recording
    this.lastTimeS = undefined;
    this.sought = null;
  }

  /** Pauses or resumes; at the end starts again. */
  toggle() {
    if (this.isAtEnd) {
      this.seek(0);
      this.connection().setParameter("playback.paused", false);
    } else {
      this.connection().setParameter("playback.paused", !this.paused);
    }
  }

  seek(positionS) {
    this.connection().setParameter("playback.position_s", positionS);
    this.show(positionS);  // at once, so that steps add up
    this.sought = {positionS, untilMs: performance.now() + SEEK_MS};
  }

  /** Shows the position reported by the server, unless it is from before a seek. */
  showReported(positionS) {
    if (this.sought && performance.now() < this.sought.untilMs) {
      const aheadS = positionS - this.sought.positionS;
      const playedS = this.paused ? 0 : Number(this.speed.value);  // the most that can have been played since
      if (aheadS < -SEEK_TOLERANCE_S || aheadS > SEEK_TOLERANCE_S + playedS) {
        return;
      }
    }
    this.sought = null;
    this.show(positionS);
  }

  /** Space pauses and resumes; comma and full stop step. Ignores Space while the focus is on an element that Space would press. */
  onKey(event) {
    if (this.form.hidden || event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    const step = {",": -STEP_S, ".": STEP_S}[event.key];
    if (event.key === " " && !event.target.closest?.("button, select, summary, input:not([type=range])")) {
      event.preventDefault();
      this.toggle();
    } else if (step) {
      event.preventDefault();
      this.connection().setParameter("playback.paused", true);
      this.seek(Math.min(Math.max(this.positionS + step, 0), this.durationS));
    }
  }

  /** Takes the server's parameters. There is a playback if they have a duration. */
  set(parameters) {
    if (!parameters.has("playback.duration_s")) {
      return;
    }
    this.form.hidden = false;
    this.durationS = parameters.get("playback.duration_s");
    this.beginS = parameters.get("playback.begin_s");
    this.paused = parameters.get("playback.paused");
    this.position.max = this.durationS;
    this.speed.value = String(parameters.get("playback.speed"));
    this.showReported(parameters.get("playback.position_s"));
    this.showState();
    this.showEvents(parameters.get("playback.events") ?? []);
    this.seekWanted();
  }

  /** Shows a mark for each event, "SECONDS KIND TEXT"; a click on a stop or a fault seeks to just before it. */
  showEvents(events) {
    const found = events.map((event) => /^(\S+) (\S+) (.*)$/s.exec(event)).filter(Boolean);
    if (this.marks.childElementCount === found.length) {
      return;
    }
    this.marks.replaceChildren(...found.map(([, seconds, kind, words]) => {
      const what = `${clockText(Number(seconds))} ${kind} ${words}`;
      const mark = kind === "keyframe" ? element("span", "", {"data-kind": kind})
        : element("button", "", {type: "button", "data-kind": kind, title: what, "aria-label": `to ${what}`});
      mark.style.left = `${100 * Number(seconds) / this.durationS}%`;
      if (kind !== "keyframe") {
        mark.addEventListener("click", () => this.seek(Math.max(0, Number(seconds) - LEAD_S)));
      }
      return mark;
    }));
  }

  /** A message's time as text: its position on the time line of a recording; live, the time of day. */
  timeText(timeS) {
    return this.beginS === undefined ? `at ${new Date(1000 * timeS).toLocaleTimeString()}` : `at ${clockText(timeS - this.beginS)}`;
  }

  /** Seeks to the time of a link, once, and pauses there. */
  seekWanted() {
    if (this.wantedS !== undefined && this.durationS > 0) {
      this.connection().setParameter("playback.paused", true);
      this.seek(Math.min(this.wantedS, this.durationS));
      this.wantedS = undefined;
    }
  }

  /** Takes the time of the recording; returns whether it has gone back. */
  onTime(timeS) {
    const back = this.lastTimeS !== undefined && timeS < this.lastTimeS;
    this.lastTimeS = timeS;
    if (this.beginS !== undefined) {
      this.showReported(timeS - this.beginS);
    }
    return back;
  }

  show(positionS) {
    this.positionS = positionS;
    if (!this.dragging) {
      this.position.value = positionS;
    }
    this.clock.textContent = `${clockText(positionS)} / ${clockText(this.durationS)}`;
    this.showState();
  }

  showState() {
    const word = this.paused || this.isAtEnd ? "Play" : "Pause";
    if (this.pause.textContent !== word) {
      this.pause.textContent = word;
    }
  }

  get isAtEnd() {
    return this.durationS > 0 && this.positionS >= this.durationS - 1e-3;
  }

  /** Whether messages are expected: not while paused or at the end. */
  get isRunning() {
    return this.form.hidden || (!this.paused && !this.isAtEnd);
  }
}
