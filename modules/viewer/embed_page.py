#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a C++ header that holds files as string views, so that the program needs no other files.

embed_page.py OUTPUT FILE...
"""
import pathlib
import sys

# Bytes per string literal; every compiler accepts this length.
PIECE = 60


def literal(content):
    """The bytes as adjacent string literals; octal escapes always end after three digits."""
    def escape(byte):
        return chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}"
    pieces = [content[i:i + PIECE] for i in range(0, len(content), PIECE)]
    return "\n".join('     "' + "".join(map(escape, piece)) + '"' for piece in pieces)


def main(output, names):
    entries = []
    for name in names:
        content = pathlib.Path(name).read_bytes()
        entries.append(f'    {{"{pathlib.Path(name).name}",\n{literal(content)}}},\n')
    pathlib.Path(output).write_text(
        "// Made by embed_page.py.\n#pragma once\n\n#include <string_view>\n\nnamespace nodmap::viewer {\n\n"
        "struct PageFile {\n  std::string_view name;\n  std::string_view content;\n};\n\n"
        "inline constexpr PageFile kPageFiles[] = {\n" + "".join(entries) + "};\n\n}  // namespace nodmap::viewer\n")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
