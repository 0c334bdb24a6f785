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

# The simulated robot from there: the sheriff ends with its script when every process has run for a second.
demo() {
  cd "$work/moved/share/nodmap"
  PATH=$work/moved/bin:$PATH NODMAP_WORLD=sim/worlds/cellar.yaml NODMAP_RUN=$work/run NODMAP_PORT=0 \
    timeout 200 "$tests/support/private_network.sh" nodmap-sheriff procman/sim.pmd --lone --script demo --on-script-complete exit
}
code=0
(demo) >"$work/log" 2>&1 || code=$?
[[ $code -eq 0 || $code -eq 77 ]] || { cat "$work/log"; echo "FAILED: the demo ends with $code"; exit 1; }
[[ $code -eq 77 ]] || [[ -n "$(ls "$work/run/logger")" ]] || { echo "FAILED: the demo records nothing"; exit 1; }
