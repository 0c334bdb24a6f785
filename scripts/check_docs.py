#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails when a document names what is not there: a link's file, a path of the repository or a test, in `code style`;
and when a README does not name a header that it should explain, in `code style` without its folder and extension.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
CODE = re.compile(r"`([^`\s]+)`")


def repository_files():
    return subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()


def unnamed_headers(files):
    """The headers that the README nearest above them does not name; those under no README but the repository's are left out."""
    spans = {pathlib.PurePath(name).parent: " ".join(re.findall(r"`([^`]+)`", (ROOT / name).read_text()))
             for name in files if name.endswith("/README.md")}
    for header in (pathlib.PurePath(name) for name in files if name.endswith(".hpp")):
        folder = next((parent for parent in header.parents if parent in spans), None)
        if folder and not {"test", "tests"} & set(header.parts) and not re.search(rf"\b{header.stem}\b", spans[folder]):
            yield f"{folder}/README.md: does not say what {header} is for"


def main():
    files = repository_files()
    tops = {name.split("/")[0] for name in files if "/" in name} - {"logs"}  # logs/ is where results go
    stems = {pathlib.PurePath(name).stem for name in files}
    # A path may leave out its extension (`modules/slam2d/test/slam2d_test`), and may name a folder.
    paths = set(files) | {name.rsplit(".", 1)[0] for name in files} | {str(parent) for name in files for parent in pathlib.PurePath(name).parents}
    errors = list(unnamed_headers(files))
    for name in (f for f in files if f.endswith(".md")):
        folder = (ROOT / name).parent
        for number, line in enumerate((ROOT / name).read_text().splitlines(), 1):
            for target in LINK.findall(line):
                if "://" not in target and not (folder / target).exists():
                    errors.append(f"{name}:{number}: the link leads nowhere: {target}")
            for word in CODE.findall(line):
                path = word.rstrip("/")
                if re.fullmatch(r"[\w./-]+", path) and "/" in path and path.split("/")[0] in tops and path not in paths:
                    errors.append(f"{name}:{number}: there is no {word}")
                elif re.fullmatch(r"\w+_test", path) and path not in stems:
                    errors.append(f"{name}:{number}: there is no test {word}")
    print("\n".join(errors) if errors else "every file that the documents name is there, and every header is named")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
