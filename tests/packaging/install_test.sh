#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs into a folder, moves the folder, and uses it from there: the programs run, another project finds the types,
# and the simulated robot drives.
#   install_test.sh BUILD_DIR
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"
build=$1
tests=$(readlink -f ..)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/moved"
"$work/moved/bin/nodmap-sheriff" "$work/moved/share/nodmap/procman/robot.pmd" --check
cmake -S consumer -B "$work/consumer" -Dnodmap_DIR="$work/moved/lib/cmake/nodmap" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --build "$work/consumer" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
"$work/consumer/consumer"

# The simulated robot from there, by the lines of docs/quickstart.md: it drives when it is released, and Ctrl-C ends everything.
cat >"$work/demo.sh" <<'SH'
set -e
nodmap-sheriff procman/sim.pmd --lone --script demo --on-script-complete stay &
sheriff=$!
nodmap-stop --go --wait 60
nodmap-watch --duration 5
kill -TERM "$sheriff"
wait "$sheriff"
SH
demo() {
  cd "$work/moved/share/nodmap"
  PATH=$work/moved/bin:$PATH NODMAP_WORLD=sim/worlds/cellar.yaml NODMAP_RUN=$work/run NODMAP_PORT=0 \
    timeout 200 "$tests/support/private_network.sh" bash "$work/demo.sh"
}
code=0
(demo) >"$work/log" 2>&1 || code=$?
[[ $code -ne 77 ]] || exit 0
fail() { cat "$work/log"; echo "FAILED: $*"; exit 1; }
[[ $code -eq 0 ]] || fail "the demo ends with $code"
[[ -n "$(ls "$work/run/logger")" ]] || fail "the demo records nothing"
python3 -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["distance_m"] < 0.5)' "$work/run/sim/result.json" || fail "the robot does not drive"
