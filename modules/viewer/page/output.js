// SPDX-License-Identifier: BSD-3-Clause
// The output of a process, in a dialog that is updated while it is open.

const PERIOD_MS = 1000;

export class Output {
  /** `ask(command)` returns a promise of {ok, text}. */
  constructor(dialog, ask) {
    this.dialog = dialog;
    this.text = dialog.querySelector("pre");
    this.ask = ask;
  }

  async show(command) {
    this.dialog.querySelector("h2").textContent = `What ${command} wrote`;
    this.text.textContent = "";
    this.dialog.show();
    while (this.dialog.open) {
      await this.update(command);
      await new Promise((done) => setTimeout(done, PERIOD_MS));
    }
  }

  async update(command) {
    const {text} = await this.ask(command);
    const words = text || "Nothing since the viewer was started.";
    if (words === this.text.textContent) {
      return;
    }
    // Scrolls to the end unless the user has scrolled away from it.
    const isAtEnd = this.text.scrollTop + this.text.clientHeight >= this.text.scrollHeight - 2;
    this.text.textContent = words;
    if (isAtEnd) {
      this.text.scrollTop = this.text.scrollHeight;
    }
  }
}
