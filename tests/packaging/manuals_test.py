#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The man pages and completions that scripts/make_man_pages.py makes: every option of every program is in both, man reads the pages, and
bash completes by them.

usage: manuals_test.py SOURCE_DIR BIN_DIR PROGRAM...
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BIN, PROGRAMS = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]


def complete(file, *words):
    """The completions that bash offers for the last of these words."""
    script = f"""source {file}; COMP_WORDS=({' '.join(f"'{word}'" for word in words)}); COMP_CWORD={len(words) - 1}
compopt() {{ :; }}
$(complete -p {words[0]} | sed 's/.*-F \\([^ ]*\\).*/\\1/'); printf '%s\\n' "${{COMPREPLY[@]}}" """
    return subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True).stdout.split()


class Manuals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        subprocess.run([SOURCE / "scripts/make_man_pages.py", BIN, cls.out, *PROGRAMS], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_option_is_in_page_and_completion(self):
        for program in PROGRAMS:
            help_text = subprocess.run([BIN / program, "--help"], capture_output=True, text=True).stdout
            page = (self.out / "man1" / f"{program}.1").read_text().replace("\\-", "-")
            words = (self.out / "completions" / program).read_text()
            options = re.findall(r"^ {2,4}(?:-\w,)?(--[a-z0-9-]+)", help_text, re.M)
            self.assertIn("--help", options)
            for option in options:
                self.assertTrue(f"\\fB{option}\\fR" in page, f"{program} {option}")
                self.assertTrue(option in words, f"{program} {option}")

    @unittest.skipUnless(shutil.which("man"), "no man")
    def test_man_reads_the_pages_without_a_warning(self):
        for page in (self.out / "man1").iterdir():
            read = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", page], capture_output=True, text=True)
            self.assertEqual((read.returncode, read.stderr), (0, ""), page.name)

    def test_bash_completes(self):
        convert, slam = self.out / "completions/nodmap-convert", self.out / "completions/nodmap-slam2d"
        self.assertEqual(complete(convert, "nodmap-convert", "inf"), ["info"])
        self.assertEqual(complete(convert, "nodmap-convert", "export", "--ch"), ["--channel"])
        self.assertEqual(complete(slam, "nodmap-slam2d", "--repl"), ["--replay"])
        self.assertEqual(complete(slam, "nodmap-slam2d", "--set", "matcher.max_it"), ["matcher.max_iterations="])
        self.assertEqual(complete(slam, "nodmap-slam2d", "--config", f"{SOURCE}/config/kurt3d/rob"), [f"{SOURCE}/config/kurt3d/robot.yaml"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
