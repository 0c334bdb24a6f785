# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/paper.md: a section for each figure, and a table of the requirements."""
import re
import subprocess

from trials import ROOT

PAGE = ROOT / "docs" / "paper.md"
HEAD = """# The paper's figures, reproduced

This page shows the figures 3 to 9 of *Continuous 3D Sensing for Navigation and SLAM in Cluttered and Dynamic Environments* (Holz, Lörken,
Surmann 2008). Each is drawn from a run of the whole robot in a simulated world (`nodmap-trial`): emulated devices, drivers, pitch controller, maps,
navigator and SLAM in one closed loop on simulated time. There are no photographs; the scenes are drawn from the simulated worlds.

    ./nodmap figures            draws all figures and writes this page
    ./nodmap figures 5 8        draws only these figures
    ./nodmap figures --no-page  only measures: prints the rows of the table below

As many runs are made in parallel as there are processors. They are deterministic: the same program makes the same images and numbers. Each section names
the commit at which it was drawn; a later version of the robot drives otherwise. Newer results of Fig. 6's comparison with a level laser are in
[bench/REPORT.md](../bench/REPORT.md). The programs in the commands below are in `build/release/bin/`, and the results are written to `logs/figures/`. The
scripts are in `scripts/figures/`: each `figN.py` lists the runs of one figure (`TRIALS`), and its `make()` draws the figure and returns the section's text.
"""


def commit():
    """The commit that is checked out, abbreviated."""
    return subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()


def section(number, made):
    """A figure's section of the page, between marks by which it is found again."""
    commands = "\n".join(f"    {command}" for command in made["commands"])
    holds = "".join(f"<!-- row {number} | {what} | {measured} | {target} | {'yes' if ok else '**no**'} -->\n"
                    for what, measured, target, ok in made.get("holds", []))
    return (f"<!-- figure {number} -->\n## Fig. {number}: {made['title']}\n\n![{made['alt']}](pictures/paper/fig{number}.png)\n\n"
            f"*The paper:* {made['paper']}\n\n*Here:* {made['measured']}\n\n{commands}\n\nDrawn at commit {commit()}.\n\n{holds}<!-- end {number} -->\n")


def read_sections():
    text = PAGE.read_text() if PAGE.exists() else ""
    return {int(number): whole for whole, number in re.findall(r"(<!-- figure (\d+) -->.*?<!-- end \2 -->\n)", text, re.S)}


def write(made):
    """Replaces the sections of these figures and keeps those of the others."""
    sections = read_sections()
    sections.update({number: section(number, each) for number, each in made.items()})
    rows = "".join(f"| [{number}](#fig-{number}-{anchor(sections[number])}) | {row} |\n" for number in sorted(sections)
                   for row in re.findall(r"<!-- row \d+ \| (.*?) -->", sections[number]))
    table = f"\n| figure | what | measured | target | holds |\n|---|---|---|---|---|\n{rows}\n"
    PAGE.write_text(HEAD + table + "\n".join(sections[number] for number in sorted(sections)))


def anchor(text):
    title = re.search(r"## Fig\. \d+: (.*)", text).group(1).lower()
    return re.sub(r"[^\w -]", "", title).replace(" ", "-")
