// SPDX-License-Identifier: BSD-3-Clause
// The results of recordings and maps: the last line in which logger and mappers mention their files.

const PERIOD_MS = 1000;
const TOLD = {
  "nodmap-logger": /recording into .*|\d+ events in \d+ files.*|deleted .*|cannot .*/,
  "nodmap-slam2d": /map (?:not )?saved.*/,
  "nodmap-slam6d": /map (?:not )?saved.*/,
};

/** The newest line of a process about its files; empty if there is none. */
export function lastTold(program, lines) {
  const told = lines.map((line) => TOLD[program]?.exec(line)?.[0]).filter(Boolean);
  return told[told.length - 1] ?? "";
}

/** `list` is the page's element, `processes()` the process list, `ask(command)` a promise of {ok, text} with what it wrote. */
export class Results {
  constructor(list, processes, ask) {
    Object.assign(this, {list, processes, ask});
    setInterval(() => this.update(), PERIOD_MS);
  }

  async update() {
    if (this.list.hidden || document.hidden || this.isAsking) {
      return;
    }
    this.isAsking = true;
    const lines = [];
    for (const {command, manager, state} of this.processes().filter(({manager}) => manager?.process_name in TOLD)) {
      const {ok, text} = await this.ask(command);
      const told = ok ? lastTold(manager.process_name, text.split("\n")) : "";
      if (told || manager.process_name === "nodmap-logger") {
        lines.push(`${command} ${state}${told ? `: ${told}` : ""}`);
      }
    }
    this.isAsking = false;
    this.list.textContent = lines.join("\n");
  }
}
