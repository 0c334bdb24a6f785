#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails when a word comes back that docs/glossary.md lists as not used (its last column, in `code style`).

A word is looked for as a whole and as a part of an identifier: `tally` finds tally_ and my_tally, not totally.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
GLOSSARY = ROOT / "docs" / "glossary.md"
# The glossary itself, and who may name old parameters in order to refuse them.
EXEMPT = re.compile(r"\bv\.renamed\(|^docs/glossary\.md$|^scripts/check_words\.py$")


def old_words():
    for line in GLOSSARY.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and len(cells) == 3:
            yield from re.findall(r"`([^`]+)`", cells[2])


def main():
    words = sorted(set(old_words()))
    pattern = re.compile(r"(?<![A-Za-z])(" + "|".join(map(re.escape, words)) + r")(?![a-z])")
    files = subprocess.run(["git", "ls-files", "*.hpp", "*.cpp", "*.py", "*.sh", "*.lcm", "*.md", "*.yaml", "*.pmd", "*.js", "nodmap"], cwd=ROOT,
                           capture_output=True, text=True, check=True).stdout.split()
    errors = []
    for name in files:
        if EXEMPT.search(name):
            continue
        for number, line in enumerate((ROOT / name).read_text(errors="replace").splitlines(), 1):
            if (found := pattern.search(line)) and not EXEMPT.search(line):
                errors.append(f"{name}:{number}: '{found.group(1)}' is not a word of the glossary: {line.strip()}")
    print("\n".join(errors) if errors else f"no word of the {len(words)} that the glossary replaced")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
