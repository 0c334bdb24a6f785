// SPDX-License-Identifier: BSD-3-Clause
// Stop, goals, processes, recordings and saving, for who has the token. Every request is answered by the server in words.

const DRAG_PX = 4;

export class Control {
  constructor(form, view, connection) {
    this.form = form;
    this.connection = connection;
    this.answer = form.querySelector("#answer");
    this.pick = form.querySelector("#pick");
    this.view = view;
    const simple = {stop: "stop", go: "go", roam: "roam", save: "save_maps", record: "start_recording", "record-end": "stop_recording"};
    Object.entries(simple).forEach(([id, what]) => form.querySelector(`#${id}`).addEventListener("click", () => this.ask({do: what})));
    this.takeGoals();
  }

  takeGoals() {
    const x = this.form.querySelector("#goal-x");
    const y = this.form.querySelector("#goal-y");
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.ask({do: "goal", x_m: Number(x.value), y_m: Number(y.value)});
    });
    this.pick.addEventListener("click", () => this.setPicking(!this.isPicking));
    const {canvas} = this.view;
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = event; });
    // Not "click": the camera's controls keep it from coming on touch screens.
    canvas.addEventListener("pointerup", (event) => {
      const dragged = !down || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > DRAG_PX;
      const at = this.isPicking && !dragged ? this.view.floorAt(event) : null;
      if (at) {
        this.setPicking(false);
        [x.value, y.value] = [at.x.toFixed(2), at.y.toFixed(2)];
        this.ask({do: "goal", x_m: at.x, y_m: at.y});
      }
    });
  }

  get isPicking() {
    return this.pick.getAttribute("aria-pressed") === "true";
  }

  setPicking(picking) {
    this.pick.setAttribute("aria-pressed", picking);
    this.view.canvas.classList.toggle("picking", picking);
  }

  async ask(request) {
    this.answer.textContent = "Asked.";
    this.answer.dataset.ok = true;
    const {ok, text} = await this.connection().call("control", request);
    this.answer.textContent = ok ? text : `Refused: ${text}`;
    this.answer.dataset.ok = ok;
  }

  /** Called for each new connection; whether processes can be started and stopped. */
  open({capabilities, metadata}) {
    this.form.hidden = !capabilities.includes("services");
    const processes = !this.form.hidden && metadata?.process_control === "true";
    this.form.querySelectorAll(".process-control").forEach((button) => { button.hidden = !processes; });
    document.body.classList.toggle("has-control", !this.form.hidden);
    return processes;
  }

  /** The STOP message: whether the robot is held. */
  showStopped(isStopped) {
    this.form.classList.toggle("stopped", isStopped);
  }
}
