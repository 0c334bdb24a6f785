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
    // The dialog may show another command before the answer about this one comes.
    const mine = this.mine = {};
    while (this.dialog.open && this.mine === mine) {
      await this.update(command, mine);
      await new Promise((done) => setTimeout(done, PERIOD_MS));
    }
  }

  async update(command, mine) {
    const {text} = await this.ask(command);
    if (this.mine !== mine) {
      return;
    }
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
