#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a C++ header with the wire layout of each type in the given .lcm files.

lcm-gen's decoders resize arrays to whatever count a message claims before they look at its size. The layouts let
common/bus walk a message first and refuse one whose counts, strings or length do not add up.
"""
import argparse
import pathlib
import re
import sys

SIZES = {"int8_t": 1, "byte": 1, "boolean": 1, "int16_t": 2, "int32_t": 4, "float": 4, "int64_t": 8, "double": 8}


class Struct:
    def __init__(self, package, name):
        self.package, self.name, self.fields = package, name, []


def parse(path):
    """The structs of one file. Raises ValueError with the offending statement."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", path.read_text(), flags=re.S)
    package = re.search(r"\bpackage\s+(\w+)\s*;", text)
    structs = []
    for name, body in re.findall(r"\bstruct\s+(\w+)\s*\{(.*?)\}", text, flags=re.S):
        struct = Struct(package.group(1) if package else "", name)
        for statement in filter(None, (s.strip() for s in body.split(";"))):
            if statement.startswith("const "):
                continue
            match = re.fullmatch(r"([\w.]+)\s+(.+)", statement, flags=re.S)
            if not match:
                raise ValueError(f"{path}: cannot read '{statement}'")
            for member in match.group(2).split(","):
                member_match = re.fullmatch(r"\s*(\w+)\s*((?:\[\s*\w+\s*\]\s*)*)", member)
                if not member_match:
                    raise ValueError(f"{path}: cannot read '{member.strip()}' in '{statement}'")
                dimensions = re.findall(r"\[\s*(\w+)\s*\]", member_match.group(2))
                struct.fields.append((match.group(1), member_match.group(1), dimensions))
        structs.append(struct)
    return structs


def layout(struct, known):
    """The C++ initialisers of the struct's WireFields."""
    counts = [d for _, _, dims in struct.fields for d in dims if not d.isdigit()]
    slots = {name: i for i, name in enumerate(dict.fromkeys(counts))}
    rows = []
    for kind, name, dimensions in struct.fields:
        fixed = 1
        variable = []
        for dimension in dimensions:
            if dimension.isdigit():
                fixed *= int(dimension)
            else:
                variable.append(slots[dimension])
        if len(variable) > 2:
            raise ValueError(f"{struct.name}.{name}: more than two variable dimensions")
        variable += [-1] * (2 - len(variable))
        nested = "{}"
        if kind in SIZES:
            size, form = SIZES[kind], "WireForm::kPlain"
        elif kind == "string":
            size, form = 0, "WireForm::kString"
        else:
            full = kind if "." in kind else f"{struct.package}.{kind}"
            if full not in known:
                raise ValueError(f"{struct.name}.{name}: unknown type {kind}")
            size, form = 0, "WireForm::kStruct"
            nested = f"WireLayout<::{full.replace('.', '::')}>::kFields"
        if name in slots and (size not in (1, 2, 4, 8) or dimensions):
            raise ValueError(f"{struct.name}.{name}: a count must be an integer")
        rows.append(f"      {{{form}, {size}, {fixed}, {{{variable[0]}, {variable[1]}}}, {slots.get(name, -1)}, {nested}}},  // {name}")
    return rows


def clearing(struct):
    """The C++ statements that empty a message's arrays: lcm-gen's decoders leave an array as it was when its count is 0."""
    lines = []
    for kind, name, dimensions in struct.fields:
        full = kind if "." in kind else f"{struct.package}.{kind}"
        if any(not d.isdigit() for d in dimensions):
            lines.append(f"    message.{name}.clear();")
        elif kind not in SIZES and kind != "string" and not dimensions:
            lines.append(f"    WireLayout<::{full.replace('.', '::')}>::clear(message.{name});")
        elif kind not in SIZES and kind != "string":
            raise ValueError(f"{struct.name}.{name}: arrays of structs of fixed size are not supported")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", required=True, type=pathlib.Path)
    parser.add_argument("files", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    structs = [struct for file in arguments.files for struct in parse(file)]
    known, done, pending = {f"{s.package}.{s.name}" for s in structs}, set(), list(structs)
    lines = ["// Generated from the .lcm files by wire_layouts.py.", "#pragma once", "", '#include "common/bus/wire_layout.hpp"', ""]
    for struct in structs:
        lines.append(f'#include "{struct.package}/{struct.name}.hpp"')
    lines += ["", "namespace nodmap::bus {"]
    while pending:  # a struct after those it holds
        ready = [s for s in pending if all(k in SIZES or k == "string" or (k if "." in k else f"{s.package}.{k}") in done for k, _, _ in s.fields)]
        if not ready:
            raise ValueError("types hold each other or are missing: " + ", ".join(s.name for s in pending))
        for struct in ready:
            lines += ["", "template <>", f"struct WireLayout<::{struct.package}::{struct.name}> {{", "  static constexpr WireField kFields[] = {"]
            lines += layout(struct, known) + ["  };", ""]
            lines += [f"  static void clear([[maybe_unused]] ::{struct.package}::{struct.name}& message) {{"] + clearing(struct) + ["  }", "};"]
            done.add(f"{struct.package}.{struct.name}")
            pending.remove(struct)
    lines += ["", "/// Every message type there is, for what looks into any log.", "[[nodiscard]] inline std::span<const MessageType> message_types() {",
              "  static const MessageType kTypes[] = {"]
    for struct in structs:
        full = f"::{struct.package}::{struct.name}"
        lines.append(f'      {{"{struct.package}.{struct.name}", {full}::getHash(), WireLayout<{full}>::kFields}},')
    lines += ["  };", "  return kTypes;", "}", "", "}  // namespace nodmap::bus", ""]
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    arguments.output.write_text("\n".join(lines))


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError) as error:
        sys.exit(f"wire_layouts.py: {error}")
