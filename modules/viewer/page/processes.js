// SPDX-License-Identifier: BSD-3-Clause
// The table of processes, from their own STATUS and from the process manager's PM_INFO.
import {element} from "./element.js";

const HEALTH = ["OK", "DEGRADED", "FAILED"];
const SILENT_S = 3;

/**
 * Each process as {key, name, command, state, level, reason, status, cpu_share}; level 0 is OK, 1 a warning, 2 an error. First
 * the process manager's commands, then all other processes.
 */
export function processList(statuses, commands) {
  const statusOf = new Map(statuses.map((status) => [status.process_name, status]));
  const programOf = (command) => command.process_name || command.command;
  const managed = commands.map((manager) => {
    const {command, host, cpu_share} = manager;
    const program = programOf(manager);
    // Several commands may run the same program, for example loggers on two hosts; each has a row with its own name.
    const isAlone = commands.filter((other) => programOf(other) === program).length === 1;
    return {key: `${host}/${command}`, name: isAlone ? program : `${command} on ${host}`, command, program, manager, cpu_share, status: statusOf.get(program)};
  });
  const known = new Set(commands.map(programOf));
  const others = statuses.filter(({process_name: name}) => !known.has(name)).map((status) => ({key: status.process_name, name: status.process_name, status}));
  return [...managed, ...others].map((process) => ({...process, ...stateOf(process)}));
}

function stateOf({status, manager}) {
  if (manager && manager.state !== "running") {
    return {state: manager.state, level: {failed: 2, "no deputy": 1}[manager.state] ?? 0, reason: manager.end};
  }
  if (!status) {
    return {state: "running", level: 0, reason: ""};
  }
  if (status.age_s > SILENT_S) {
    return {state: "silent", level: 1, reason: "has not reported for several seconds"};
  }
  return {state: HEALTH[status.health] ?? "unknown", level: status.health, reason: status.health_reason};
}

/** The number of messages that were received but not used. */
function refused({total_corrupt: corrupt, total_rejected: rejected}) {
  return [[corrupt, "corrupt"], [rejected, "rejected"]].filter(([count]) => count > 0).map(([count, what]) => `${count} ${what}`).join(", ");
}

/** The table's body. `ask(what, command, program)` starts, stops or restarts a command; `showOutput(command)` shows its output. There are buttons while `canControl`. */
export class Processes {
  constructor(body, ask, showOutput) {
    this.body = body;
    this.ask = ask;
    this.showOutput = showOutput;
    this.rows = new Map();
    this.canControl = false;
  }

  show(processes) {
    const keys = new Set(processes.map(({key}) => key));
    [...this.rows.keys()].filter((key) => !keys.has(key)).forEach((key) => this.rows.delete(key));
    const rows = processes.map((process) => this.row(process));
    // Rows are reused, so that a button keeps the focus.
    if (rows.length !== this.body.rows.length || rows.some((row, i) => row !== this.body.rows[i])) {
      this.body.replaceChildren(...rows);
    }
  }

  row(process) {
    if (!this.rows.has(process.key)) {
      this.rows.set(process.key, this.makeRow(process));
    }
    const row = this.rows.get(process.key);
    const status = process.manager && process.manager.state !== "running" ? undefined : process.status;  // otherwise STATUS is from before the end
    const state = element("td", process.state, {"data-level": process.level});
    const notes = [process.reason, status ? refused(status) : ""].filter(Boolean).join("; ");
    if (notes) {
      state.append(element("small", notes));
    }
    const number = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : "");
    const cells = [
      state, element("td", number(status?.handled_per_s, 0)), element("td", number(status && status.latency_p99_us / 1000, 1)),
      element("td", status?.total_lost ?? ""), element("td", Number.isFinite(process.cpu_share) && status ? `${(100 * process.cpu_share).toFixed(0)} %` : ""),
    ];
    [...row.cells].slice(1).forEach((cell) => cell.remove());
    row.append(...cells);
    this.showButtons(row.cells[0], process);
    return row;
  }

  makeRow({name, program}) {
    const row = element("tr", "");
    const head = element("th", name.replace(/^nodmap-/, ""), {scope: "row"});
    const buttons = element("span", "", {class: "buttons"});
    for (const [what, sign] of [["start", "▶"], ["restart", "↻"], ["stop", "■"]]) {
      const button = element("button", sign, {type: "button", "data-do": what, "aria-label": `${what} ${name}`, title: `${what} ${name}`});
      button.addEventListener("click", () => this.ask(what, row.dataset.command, program));
      buttons.append(button);
    }
    const output = element("button", "≡", {type: "button", "data-do": "output", "aria-label": `output of ${name}`, title: `what ${name} wrote`});
    output.addEventListener("click", () => this.showOutput(row.dataset.command));
    buttons.append(output);
    head.append(buttons);
    row.append(head);
    return row;
  }

  showButtons(head, {command, manager}) {
    head.parentElement.dataset.command = command ?? "";
    head.querySelector(".buttons").hidden = !this.canControl || !command;
    const running = manager?.state === "running";
    head.querySelector("[data-do=start]").disabled = running || manager?.state === "no deputy";
    head.querySelector("[data-do=restart]").disabled = !running;
    head.querySelector("[data-do=stop]").disabled = !running;
  }
}
