#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails when a document names what is not there: a link's file or heading, a path of the repository or a test (`x_test`, `Suite.Name`), in `code style`;
when a README does not name a header that it should explain, in `code style` without its folder and extension; when an entry of bench/REPORT.md
does not name its commit; and when a comment refers to a requirement (R1) that tests/README.md does not list.
"""
import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]+))?[^)]*\)")
CODE = re.compile(r"`([^`\s]+)`")
ENTRY = re.compile(r"### .*\(.*\b(?=[0-9a-f]*\d)[0-9a-f]{7,10}\b.*\)$")
TEST = re.compile(r"([A-Z]\w+)\.([A-Z]\w+|\*)")


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


def entries_without_commit(report):
    """Entries of the report of benchmarks whose title does not say of which commit the results are."""
    for number, line in enumerate((ROOT / report).read_text().splitlines(), 1):
        if line.startswith("### ") and not ENTRY.fullmatch(line):
            yield f"{report}:{number}: the entry names no commit: {line}"


def unknown_requirements(files):
    """Comments about a requirement that is not in the table of tests/README.md, where a row may be about several: R10, R11 or R13 to R27."""
    known = set()
    for row in re.findall(r"^\| (R\d[^|]*) \|", (ROOT / "tests" / "README.md").read_text(), re.M):
        numbers = [int(number) for number in re.findall(r"\d+", row)]
        known |= set(range(numbers[0], numbers[-1] + 1)) if " to " in row else set(numbers)
    for name in (f for f in files if f.endswith((".cpp", ".hpp"))):
        for number, line in enumerate((ROOT / name).read_text().splitlines(), 1):
            for requirement in re.findall(r"\bR(\d{1,2})\b", line.partition("//")[2]):
                if int(requirement) not in known:
                    yield f"{name}:{number}: tests/README.md has no requirement R{requirement}"


def test_names(files):
    """Suite.Name of each GoogleTest, and Suite.* of each suite."""
    sources = (name for name in files if name.endswith("_test.cpp"))
    found = {match for name in sources for match in re.findall(r"TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)", (ROOT / name).read_text())}
    return {f"{suite}.{name}" for suite, test in found for name in (test, "*")}


@functools.cache
def anchors(document):
    """What a link to a heading of the document may have after its #, by GitHub's rule."""
    found = {}
    for title in re.findall(r"^#+ (.*)$", document.read_text(), re.M):
        name = re.sub(r"[^\w -]", "", re.sub(r"\]\([^)]*\)", "", title).lower()).replace(" ", "-")
        found[name] = found.get(name, -1) + 1
    return set(found) | {f"{name}-{number}" for name, count in found.items() for number in range(1, count + 1)}


def is_there(document, target, heading):
    """Whether a link of a document leads somewhere."""
    path = document.parent / target if target else document
    return path.exists() and (not heading or path.suffix != ".md" or heading in anchors(path))


def main():
    files = repository_files()
    tops = {name.split("/")[0] for name in files if "/" in name} - {"logs"}  # logs/ is where results go
    stems = {pathlib.PurePath(name).stem for name in files}
    # A path may leave out its extension (`modules/slam2d/test/slam2d_test`), and may name a folder.
    paths = set(files) | {name.rsplit(".", 1)[0] for name in files} | {str(parent) for name in files for parent in pathlib.PurePath(name).parents}
    tests = test_names(files)
    suites = {name.split(".")[0] for name in tests}
    errors = [*unnamed_headers(files), *entries_without_commit("bench/REPORT.md"), *unknown_requirements(files)]
    for name in (f for f in files if f.endswith(".md")):
        for number, line in enumerate((ROOT / name).read_text().splitlines(), 1):
            for target, heading in LINK.findall(line):
                if "://" not in target and not is_there(ROOT / name, target, heading):
                    errors.append(f"{name}:{number}: the link leads nowhere: {target}{'#' if heading else ''}{heading}")
            for word in CODE.findall(line):
                path = word.rstrip("/")
                if re.fullmatch(r"[\w./-]+", path) and "/" in path and path.split("/")[0] in tops and path not in paths:
                    errors.append(f"{name}:{number}: there is no {word}")
                elif re.fullmatch(r"\w+_test", path) and path not in stems:
                    errors.append(f"{name}:{number}: there is no test {word}")
                elif TEST.fullmatch(word) and (name == "SAFETY.md" or word.split(".")[0] in suites) and word not in tests:
                    errors.append(f"{name}:{number}: there is no test {word}")
    print("\n".join(errors) if errors else "every file that the documents name is there, every header is named, and every benchmark names its commit")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
