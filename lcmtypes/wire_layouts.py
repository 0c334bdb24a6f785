#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a C++ header with the wire layout of each type in the given .lcm files.

lcm-gen's decoders resize arrays to the count that a message claims, before they check the message's size. The layouts let
common/bus walk a message first and refuse one whose counts, strings or length do not add up.
"""
import argparse
import pathlib
import sys

from lcm_files import SIZES, parse


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
    known, done, pending = {s.full_name for s in structs}, set(), list(structs)
    lines = ["// Generated from the .lcm files by wire_layouts.py.", "#pragma once", "", '#include "common/bus/wire_layout.hpp"', ""]
    for struct in structs:
        lines.append(f'#include "{struct.package}/{struct.name}.hpp"')
    lines += ["", "namespace nodmap::bus {"]
    while pending:  # a struct comes after those that it contains
        ready = [s for s in pending if all(k in SIZES or k == "string" or (k if "." in k else f"{s.package}.{k}") in done for k, _, _ in s.fields)]
        if not ready:
            raise ValueError("types hold each other or are missing: " + ", ".join(s.name for s in pending))
        for struct in ready:
            lines += ["", "template <>", f"struct WireLayout<{struct.cpp_name}> {{", "  static constexpr WireField kFields[] = {"]
            lines += layout(struct, known) + ["  };", ""]
            lines += [f"  static void clear([[maybe_unused]] {struct.cpp_name}& message) {{"] + clearing(struct) + ["  }", "};"]
            done.add(struct.full_name)
            pending.remove(struct)
    lines += ["", "/// Every message type there is, for what looks into any log.", "[[nodiscard]] inline std::span<const MessageType> message_types() {",
              "  static const MessageType kTypes[] = {"]
    for struct in structs:
        begins_with_utime = str(struct.fields[0][:2] == ("int64_t", "utime")).lower()
        lines.append(f'      {{"{struct.full_name}", {struct.cpp_name}::getHash(), WireLayout<{struct.cpp_name}>::kFields, {begins_with_utime}}},')
    lines += ["  };", "  return kTypes;", "}", "", "}  // namespace nodmap::bus", ""]
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    arguments.output.write_text("\n".join(lines))


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError) as error:
        sys.exit(f"wire_layouts.py: {error}")
