#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a C++ header and source that turn messages into JSON: for each type of the package nodmap its fields under the names of the
.lcm file, its JSON Schema, and the names of its constants.

Arrays of variable length, or of more than MAX_ELEMENTS, are left out: scans, maps and covariances are drawn, not shown in tables and
plots. A type with constants has one field of their type. The name of that field's constant is added as <field>_name, unless the field
is an array.
"""
import argparse
import json
import math
import pathlib
import sys

from lcm_files import SIZES, parse

MAX_ELEMENTS = 16
# A number that is not finite is null in JSON.
SCHEMAS = {"boolean": "boolean", "string": "string", "float": ["number", "null"], "double": ["number", "null"]}

HEADER = """// Generated from the .lcm files by json_messages.py.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace nodmap {{
{declarations}

/// A message type as JSON: its name, and a message field by field under the names of its .lcm file.
template <class Message>
struct JsonMessage;
{specialisations}

/// The JSON Schema of each type, by its name.
[[nodiscard]] const std::map<std::string, std::string>& json_message_schemas();

}}  // namespace nodmap
"""

SPECIALISATION = """
template <>
struct JsonMessage<{struct.cpp_name}> {{
  static constexpr const char* kName = "{struct.full_name}";
  [[nodiscard]] static nlohmann::json fields(const {struct.cpp_name}& message);{constants}
}};"""

CONSTANTS = """
  /// The name of the constant of this value, or "UNKNOWN".
  [[nodiscard]] static const char* constant_name(std::int64_t value);"""

SOURCE = """// Generated from the .lcm files by json_messages.py.
#include "nodmap/json_messages.hpp"

#include <nlohmann/json.hpp>

{includes}

namespace nodmap {{
{functions}

const std::map<std::string, std::string>& json_message_schemas() {{
  static const std::map<std::string, std::string> kSchemas{{
{schemas}}};
  return kSchemas;
}}

}}  // namespace nodmap
"""


def converted_fields(struct):
    """(name, JSON Schema, C++ expression) of each converted field, and of the constant's name."""
    converted = []
    for kind, name, dimensions in struct.fields:
        if kind not in SIZES and kind != "string":
            raise ValueError(f"{struct.name}.{name}: messages within messages are not supported")
        if not all(d.isdigit() for d in dimensions) or math.prod(map(int, dimensions)) > MAX_ELEMENTS:
            continue
        schema = {"type": SCHEMAS.get(kind, "integer")}
        for _ in dimensions:
            schema = {"type": "array", "items": schema}
        converted.append((name, schema, f"message.{name}" + (" != 0" if kind == "boolean" else "")))
    if struct.constants:
        kinds = {kind for kind, _, _ in struct.constants}
        named = [(name, dimensions) for kind, name, dimensions in struct.fields if kind in kinds]
        if len(named) != 1:
            raise ValueError(f"{struct.name}: it is not clear which field has the constants")
        name, dimensions = named[0]
        if not dimensions:
            converted.append((f"{name}_name", {"type": "string"}, f"constant_name(message.{name})"))
    return converted


def functions_of(struct):
    rows = ",\n".join(f'      {{"{name}", {value}}}' for name, _, value in converted_fields(struct))
    lines = [f"\nnlohmann::json JsonMessage<{struct.cpp_name}>::fields(const {struct.cpp_name}& message) {{", f"  return {{\n{rows}}};", "}"]
    if struct.constants:
        lines += [f"\nconst char* JsonMessage<{struct.cpp_name}>::constant_name(std::int64_t value) {{", "  switch (value) {"]
        lines += [f'    case {value}:\n      return "{name}";' for _, name, value in struct.constants]
        lines += ['    default:\n      return "UNKNOWN";', "  }", "}"]
    return "\n".join(lines)


def schema_of(struct):
    schema = {"title": struct.full_name, "type": "object", "properties": {name: schema for name, schema, _ in converted_fields(struct)}}
    return json.dumps(schema, sort_keys=True, separators=(",", ":"))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--header", required=True, type=pathlib.Path)
    parser.add_argument("--source", required=True, type=pathlib.Path)
    parser.add_argument("files", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    structs = [struct for file in arguments.files for struct in parse(file) if struct.package == "nodmap"]
    arguments.header.write_text(HEADER.format(
        declarations="\n".join(f"class {struct.name};" for struct in structs),
        specialisations="\n".join(SPECIALISATION.format(struct=struct, constants=CONSTANTS if struct.constants else "") for struct in structs)))
    arguments.source.write_text(SOURCE.format(
        includes="\n".join(f'#include "nodmap/{struct.name}.hpp"' for struct in structs),
        functions="\n".join(functions_of(struct) for struct in structs),
        schemas=",\n".join(f'      {{"{struct.full_name}", R"({schema_of(struct)})"}}' for struct in structs)))


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError) as error:
        sys.exit(f"json_messages.py: {error}")
