#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What scripts/test_summary.py says of CTest's report on tests that pass, fail, skip themselves and cannot be run.

usage: test_summary_test.py SOURCE_DIR
"""
import pathlib
import subprocess
import sys
import tempfile

CMAKE = """
cmake_minimum_required(VERSION 3.25)
project(made_up NONE)
enable_testing()
add_test(NAME passes COMMAND true)
add_test(NAME fails COMMAND false)
add_test(NAME skips COMMAND sh -c "echo missing data: some.log; exit 77")
add_test(NAME not_there COMMAND ${CMAKE_BINARY_DIR}/not_there)
add_test(made_up_NOT_BUILT made_up_NOT_BUILT)
set_tests_properties(skips PROPERTIES SKIP_RETURN_CODE 77)
"""

SUMMARY = """\
4 3 1
4 tests ran, 3 failed, 1 were skipped
  FAILED: fails
  FAILED: not_there: Unable to find executable
  FAILED: made_up_NOT_BUILT: Unable to find executable
  skipped: skips: missing data: some.log
"""


def main():
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.xml"
        (pathlib.Path(folder) / "CMakeLists.txt").write_text(CMAKE)
        subprocess.run(["cmake", "-S", folder, "-B", folder], check=True, capture_output=True)
        subprocess.run(["ctest", "--test-dir", folder, "--output-junit", report], capture_output=True)
        summary = subprocess.run([sys.executable, f"{sys.argv[1]}/scripts/test_summary.py", report], check=True, capture_output=True, text=True).stdout
    assert summary == SUMMARY, summary


if __name__ == "__main__":
    main()
