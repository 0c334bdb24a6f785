// SPDX-License-Identifier: BSD-3-Clause
// Stop, goals, processes, recordings and saving, for users with the token. The server answers every request with a text.

// An answer comes at once unless the link is down; later, the server carries out nothing but STOP (RemoteControl::kMaxAge).
const LATE_MS = 2000;
// How long an answer to STOP may take at first, and at most after each connection that has brought none.
const STOP_MS = 1000;
const MAX_STOP_MS = 8000;

/** The key of a keyboard event; by its place where the layout has other letters than Latin ones. */
export function keyOf({key, code}) {
  const isOther = /^[^\x00-\x7f]$/.test(key) && code.startsWith("Key");
  return (isOther ? code.slice("Key".length) : key).toLowerCase();
}

export class Control {
  /** `stopBar` holds STOP and "Release", `form` everything else. */
  constructor(stopBar, form, view, connection) {
    this.stopBar = stopBar;
    this.form = form;
    this.connection = connection;
    this.answer = form.querySelector("#answer");
    this.pick = form.querySelector("#pick");
    this.view = view;
    this.stopMs = null;  // while a STOP has no answer: how long one may take
    const simple = {go: "go", home: "home", roam: "roam", explore: "explore", "explore-end": "end_exploration", save: "save_maps", record: "start_recording", "record-end": "stop_recording"};
    Object.entries(simple).forEach(([id, what]) => document.getElementById(id).addEventListener("click", () => this.ask({do: what})));
    document.getElementById("stop").addEventListener("click", () => this.stop());
    document.addEventListener("keydown", (event) => this.onKey(event));
    this.takeGoals();
  }

  /** S stops the robot whatever has the focus, because no field of the page takes letters. Escape ends the choice of a goal. */
  onKey(event) {
    if (keyOf(event) === "s" && !event.ctrlKey && !event.altKey && !event.metaKey && !this.stopBar.hidden) {
      event.preventDefault();
      this.stop();
    } else if (event.key === "Escape" && this.isPicking) {
      this.setPicking(false);
    }
  }

  takeGoals() {
    const x = this.form.querySelector("#goal-x");
    const y = this.form.querySelector("#goal-y");
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      const empty = [x, y].find((field) => !Number.isFinite(field.valueAsNumber));
      if (empty) {
        empty.focus();
        this.showAnswer(false, "Not sent: a goal needs x and y, in metres.");
        return;
      }
      this.ask({do: "goal", x_m: x.valueAsNumber, y_m: y.valueAsNumber});
    });
    this.pick.addEventListener("click", () => this.setPicking(!this.isPicking));
    this.view.onClickMode((mode) => this.pick.setAttribute("aria-pressed", mode === "goal"));
    this.view.onClick((event) => {
      const at = this.isPicking ? this.view.floorAt(event) : null;
      if (at) {
        this.setPicking(false);
        [x.value, y.value] = [at.x.toFixed(2), at.y.toFixed(2)];
        this.ask({do: "goal", x_m: at.x, y_m: at.y});
      }
    });
  }

  get isPicking() {
    return this.view.clickMode === "goal";
  }

  setPicking(picking) {
    this.view.setClickMode(picking ? "goal" : "none");
  }

  /**
   * Sends STOP until it is answered. A connection may be dead without anybody knowing: one that brings no answer is replaced. The server obeys a
   * STOP of any age, however often.
   */
  stop() {
    this.stopMs ??= STOP_MS;
    this.showAnswer(true, "Asked.");
    this.sendStop();
  }

  /** To be called as soon as a new connection can take it. */
  async sendStop() {
    if (this.stopMs === null) {
      return;
    }
    const late = setTimeout(() => {
      if (this.stopMs !== null) {
        this.stopMs = Math.min(2 * this.stopMs, MAX_STOP_MS);
        this.connection().renew();
      }
    }, this.stopMs);
    const {ok, text, isLost} = await this.connection().call("control", {do: "stop"});
    clearTimeout(late);
    if (!isLost) {
      this.stopMs = null;
      this.showAnswer(ok, ok ? text : `Refused: ${text}`);
    } else if (this.stopMs !== null) {
      this.showAnswer(false, "STOP has no answer yet: it is sent again until it has one.");
    }
  }

  async ask(request) {
    if (request.do === "go" && this.stopMs !== null) {
      this.showAnswer(false, "Not sent: STOP has no answer yet, and is sent again until it has one.");
      return;
    }
    this.showAnswer(true, "Asked.");
    const late = setTimeout(() => this.showAnswer(false, "No answer yet."), LATE_MS);
    const {ok, text} = await this.connection().call("control", request);
    clearTimeout(late);
    this.showAnswer(ok, ok ? text : `Refused: ${text}`);
  }

  showAnswer(ok, text) {
    this.answer.textContent = text;
    this.answer.dataset.ok = ok;
  }

  /** To be called for each new connection; returns whether processes can be started and stopped. */
  open({capabilities, metadata}) {
    this.form.hidden = this.stopBar.hidden = !capabilities.includes("services");
    this.stopMs = this.form.hidden ? null : this.stopMs;  // nobody takes a STOP from a page that may only read
    const processes = !this.form.hidden && metadata?.process_control === "true";
    this.form.querySelectorAll(".process-control").forEach((part) => { part.hidden = !processes; });
    document.body.classList.toggle("has-control", !this.form.hidden);
    return processes;
  }

  /** Whether somebody wants the robot to be stopped: then "Release" stands out. */
  showStopped(isStopped) {
    this.stopBar.classList.toggle("stopped", isStopped);
  }
}
