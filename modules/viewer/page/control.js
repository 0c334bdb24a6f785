// SPDX-License-Identifier: BSD-3-Clause
// Goals, stop and saving, for who has the token.

const TOPICS = ["GOAL", "STOP", "SAVE_REQUEST"];

export class Control {
  constructor(form, view, connection) {
    this.form = form;
    this.answer = form.querySelector("#answer");
    const pick = form.querySelector("#pick");
    const say = (text) => { this.answer.textContent = text; };
    const send = (topic, message, text) => {
      connection().publish(topic, message);
      say(text);
    };
    form.querySelector("#stop").addEventListener("click", () => send("STOP", {}, "Stop sent."));
    form.querySelector("#roam").addEventListener("click", () => send("GOAL", {clear: true}, "No goal any more: the robot roams."));
    form.querySelector("#save").addEventListener("click", () => send("SAVE_REQUEST", {}, "Maps are to be saved."));
    pick.addEventListener("click", () => pick.setAttribute("aria-pressed", pick.getAttribute("aria-pressed") !== "true"));
    view.canvas.addEventListener("click", (event) => {
      const at = pick.getAttribute("aria-pressed") === "true" ? view.floorAt(event) : null;
      if (at) {
        pick.setAttribute("aria-pressed", "false");
        send("GOAL", {x_m: at.x, y_m: at.y}, `Goal: x ${at.x.toFixed(2)} m, y ${at.y.toFixed(2)} m.`);
      }
    });
  }

  /** Called for each new connection. */
  open(connection, capabilities) {
    this.form.hidden = !capabilities.includes("clientPublish");
    if (!this.form.hidden) {
      connection.advertise(TOPICS);
    }
  }

  refused(reason) {
    this.answer.textContent = `Refused: ${reason}.`;
  }
}
