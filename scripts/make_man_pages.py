#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Man pages and bash completions of all programs, from what each says of itself: --help, that of its subcommands, and --dump-params.

usage: make_man_pages.py BIN_DIR OUT_DIR PROGRAM...       writes OUT_DIR/man1/PROGRAM.1 and OUT_DIR/completions/PROGRAM
"""
import os
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"^ {2,4}(-\S+)(.*)$")
WORD = re.compile(r"^ {2}([A-Za-z]\S*)(.*)$")
FILE_OPTIONS = {"--config", "--replay", "--out", "--world", "--logs", "--json", "--procman", "--links"}


def run(*command):
    # Nobody's network is needed for a help text.
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, env={**os.environ, "LCM_DEFAULT_URL": "memq://"})


class Entry:
    """One option, argument or subcommand: its names, what follows them, and what it means."""

    def __init__(self, names, rest):
        self.names = names
        split = re.split(r" {2,}", rest.strip(), maxsplit=1) if rest.startswith(" ") and not rest.startswith("  ") else ["", rest.strip()]
        self.value, self.text = split[0], split[1] if len(split) > 1 else ""

    @property
    def takes_value(self):
        return bool(self.value) and not self.value.startswith(("Needs:", "Excludes:"))


class Help:
    """A --help text in its parts."""

    def __init__(self, text):
        lines = text.splitlines()
        self.summary = lines[0].strip() if lines else ""
        self.usage = next((line[len("Usage: "):] for line in lines if line.startswith("Usage: ")), "")
        self.options, self.positionals, self.subcommands, self.notes = [], [], [], []
        section, last = None, None
        for line in lines[1:]:
            heading = re.match(r"^\s*(Options|Positionals|Subcommands):$", line)
            option, word = OPTION.match(line), WORD.match(line)
            if heading:
                section, last = {"Options": self.options, "Positionals": self.positionals, "Subcommands": self.subcommands}[heading[1]], None
            elif section is self.options and option:
                last = Entry(option[1].split(","), option[2])
                section.append(last)
            elif section is not None and section is not self.options and word:
                last = Entry([word[1]], word[2])
                section.append(last)
            elif last is not None and re.match(r"^ {20,}\S", line):
                last.text = (last.text + " " + line.strip()).strip()
            elif line and not line.startswith((" ", "[", "Usage: ")):
                self.notes.append(line)


class Program:
    def __init__(self, path):
        self.name = path.name
        self.help = Help(run(path, "--help").stdout)
        self.version = run(path, "--version").stdout.strip()
        self.subcommands = [(entry, Help(run(path, entry.names[0], "--help").stdout)) for entry in self.help.subcommands]
        has_params = any("--dump-params" in option.names for option in self.help.options)
        self.params = run(path, "--dump-params").stdout if has_params else ""


def roff(text):
    escaped = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + escaped if escaped.startswith(".") else escaped


def man_entries(title, entries):
    lines = [f".SH {title}"] if entries and title else []
    for entry in entries:
        names = ", ".join(f"\\fB{roff(name)}\\fR" for name in entry.names)
        lines += [".TP", f"{names} {roff(entry.value)}".rstrip(), roff(entry.text)]
    return lines


def man_page(program):
    lines = [f'.TH {program.name.upper()} 1 "" "nodmap {program.version}" "nodmap"', ".SH NAME",
             f"{roff(program.name)} \\- {roff(program.help.summary.rstrip('.'))}", ".SH SYNOPSIS", roff(program.help.usage)]
    lines += man_entries("ARGUMENTS", program.help.positionals) + man_entries("OPTIONS", program.help.options)
    if program.subcommands:
        lines.append(".SH SUBCOMMANDS")
    for entry, text in program.subcommands:
        lines += [f".SS {roff(entry.names[0])}", roff(text.summary), ".PP", roff(text.usage)]
        lines += man_entries("", text.positionals + [option for option in text.options if "--help" not in option.names])
    if program.params:
        lines += [".SH PARAMETERS", "With their defaults, for a file given to \\fB\\-\\-config\\fR, or one by one: \\fB\\-\\-set section.key=value\\fR.",
                  ".PP", ".nf"] + [roff(line) for line in program.params.splitlines()] + [".fi"]
    lines += [".SH EXIT STATUS"]
    lines += [roff(note) for note in program.help.notes] or ["0: done. 1: it could not be done. 2: the command line, the configuration or a file that it names is wrong."]
    return "\n".join(line for line in lines if line) + "\n"


def option_words(text):
    return [name for option in text.options for name in option.names if name.startswith("--")]


def completion(program):
    function = "_" + program.name.replace("-", "_")
    keys = re.findall(r"^(\s*)([a-z_0-9]+):(.*)$", program.params, re.M)
    path, names = [], []
    for indent, key, value in keys:
        path = path[:len(indent) // 2] + [key]
        if value.strip():
            names.append(".".join(path) + "=")
    every = [program.help] + [text for _, text in program.subcommands]
    valued = {name for text in every for option in text.options if option.takes_value for name in option.names}
    lines = ["# bash completion, made from the program's own --help", f"{function}() {{", '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command="" each',
             "  COMPREPLY=()"]
    if names:
        lines += ['  if [[ $before == --set ]]; then', "    compopt -o nospace", f"    COMPREPLY=($(compgen -W '{' '.join(names)}' -- \"$word\"))", "    return", "  fi"]
    files = sorted(valued & FILE_OPTIONS)
    if files:
        lines += [f"  case $before in {' | '.join(files)}) compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\")); return ;; esac"]
    others = sorted(valued - FILE_OPTIONS - {"--set"})
    if others:
        lines += [f"  case $before in {' | '.join(others)}) return ;; esac"]
    if program.subcommands:
        commands = [entry.names[0] for entry, _ in program.subcommands]
        lines += ['  for each in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do', f"    case $each in {' | '.join(commands)}) command=$each; break ;; esac", "  done",
                  "  local words='" + " ".join(option_words(program.help) + commands) + "'", "  case $command in"]
        lines += [f"    {entry.names[0]}) words='{' '.join(option_words(text))}' ;;" for entry, text in program.subcommands]
        lines += ["  esac", '  COMPREPLY=($(compgen -W "$words" -- "$word"))', "  [[ -z $command ]] || ((${#COMPREPLY[@]})) || { compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\")); }"]
    else:
        lines += [f"  if [[ $word == -* || -z '{' '.join(entry.names[0] for entry in program.help.positionals)}' ]]; then",
                  f"    COMPREPLY=($(compgen -W '{' '.join(option_words(program.help))}' -- \"$word\"))", "  else", "    compopt -o filenames", '    COMPREPLY=($(compgen -f -- "$word"))', "  fi"]
    return "\n".join(lines + ["}", f"complete -F {function} {program.name}"]) + "\n"


def main():
    bin_dir, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    for folder in ("man1", "completions"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    for name in sys.argv[3:]:
        program = Program(bin_dir / name)
        (out / "man1" / f"{name}.1").write_text(man_page(program))
        (out / "completions" / name).write_text(completion(program))


if __name__ == "__main__":
    main()
