#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails when a word comes back that docs/glossary.md lists as not used (its last column, in `code style`).

A word is looked for as a whole and as a part of an identifier: `tally` finds Tally, tally_, myTally and MY_TALLY, not totally. A word
with a capital letter is found only with that letter: `Thinner` finds PointThinner, not a thinner rod.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
GLOSSARY = ROOT / "docs" / "glossary.md"
# The glossary itself, and who may name old parameters in order to refuse them.
EXEMPT = re.compile(r"\bv\.renamed\(|^docs/glossary\.md$|^scripts/check_words\.py$")
# A part of an identifier: Image, image, LCM.
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def old_words():
    for line in GLOSSARY.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and len(cells) == 3:
            yield from re.findall(r"`([^`]+)`", cells[2])


def in_parts(text):
    """Each identifier as its parts between underscores: toImage, to_image -> _to_Image_, _to_image_."""
    return " ".join(f"_{'_'.join(PART.findall(name))}_" for name in re.findall(r"\w+", text))


def find_word(words, line):
    parts = in_parts(line)
    lower = parts.lower()
    return next((word for word, its_parts in words.items() if its_parts in (lower if word.islower() else parts)), None)


def main():
    words = {word: in_parts(word) for word in sorted(set(old_words()))}
    files = subprocess.run(["git", "ls-files", "*.hpp", "*.cpp", "*.py", "*.sh", "*.lcm", "*.md", "*.yaml", "*.pmd", "*.js", "*.html", "*.css", "nodmap"], cwd=ROOT,
                           capture_output=True, text=True, check=True).stdout.split()
    errors = []
    for name in files:
        if EXEMPT.search(name):
            continue
        for number, line in enumerate((ROOT / name).read_text(errors="replace").splitlines(), 1):
            if (found := find_word(words, line)) and not EXEMPT.search(line):
                errors.append(f"{name}:{number}: '{found}' is not a word of the glossary: {line.strip()}")
    print("\n".join(errors) if errors else f"no word of the {len(words)} that the glossary replaced")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
