// SPDX-License-Identifier: BSD-3-Clause
// Pause, time line and speed of a recording.

function clockText(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

export class Playback {
  constructor(form, connection) {
    this.form = form;
    this.pause = form.querySelector("#pause");
    this.position = form.querySelector("#position");
    this.clock = form.querySelector("#clock");
    this.speed = form.querySelector("#speed");
    this.durationS = 0;
    this.paused = false;
    this.dragging = false;
    this.pause.addEventListener("click", () => connection().setParameter("playback.paused", !this.paused));
    this.speed.addEventListener("change", () => connection().setParameter("playback.speed", Number(this.speed.value)));
    this.position.addEventListener("pointerdown", () => { this.dragging = true; });
    this.position.addEventListener("change", () => {
      this.dragging = false;
      connection().setParameter("playback.position_s", Number(this.position.value));
    });
  }

  /** The server's parameters: there is a playback where it has a duration. */
  set(parameters) {
    if (!parameters.has("playback.duration_s")) {
      return;
    }
    this.form.hidden = false;
    this.durationS = parameters.get("playback.duration_s");
    this.paused = parameters.get("playback.paused");
    this.position.max = this.durationS;
    this.pause.textContent = this.paused ? "Play" : "Pause";
    this.speed.value = String(parameters.get("playback.speed"));
    this.show(parameters.get("playback.position_s"));
    this.beginS = this.lastTimeS === undefined ? undefined : this.lastTimeS - parameters.get("playback.position_s");
  }

  /** The time of the recording. True when it has gone back. */
  onTime(timeS) {
    const back = this.lastTimeS !== undefined && timeS < this.lastTimeS;
    this.lastTimeS = timeS;
    if (this.beginS !== undefined) {
      this.show(timeS - this.beginS);
    }
    return back;
  }

  show(positionS) {
    this.positionS = positionS;
    if (!this.dragging && document.activeElement !== this.position) {
      this.position.value = positionS;
    }
    this.clock.textContent = `${clockText(positionS)} / ${clockText(this.durationS)}`;
  }

  /** Whether messages are to come: not while it pauses or at its end. */
  get isRunning() {
    return this.form.hidden || (!this.paused && this.positionS < this.durationS);
  }
}
