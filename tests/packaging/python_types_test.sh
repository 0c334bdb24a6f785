#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The command by which docs/quickstart.md makes the message types for Python, in the project's folder: it makes them where it says, and they work.
#   python_types_test.sh SOURCE_DIR LCM_GEN
set -euo pipefail
cd "$1"
PATH=$(dirname "$2"):$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { cat "$work/log"; echo "FAILED: $*"; exit 1; }

command=$(grep -o '`lcm-gen -p [^`]*`' docs/quickstart.md | tr -d '`')
echo "$command"
untracked=$(git status --porcelain 2>/dev/null || true)
eval "${command//DIR/$work/types}" >"$work/log" 2>&1 || fail "lcm-gen"  # ends with 0 even if it has written nothing
[[ "$(git status --porcelain 2>/dev/null || true)" == "$untracked" ]] || fail "files are left in the project's folder"
PYTHONPATH=$work/types python3 - >"$work/log" 2>&1 <<'PY' || fail "the types"
import nodmap
scan = nodmap.scan_t()
scan.utime, scan.num_ranges, scan.ranges_m = 5, 2, [1.5, 2.5]
assert list(nodmap.scan_t.decode(scan.encode()).ranges_m) == [1.5, 2.5]
PY
