#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Kills each process of the simulated robot in turn (kill -9): the deputy starts it again, and its STATUS is OK again. The simulator, which has
# no auto_respawn, is reported as ended by the signal. No other process is started again. A process that hangs (SIGSTOP) is restarted by the
# sheriff, by the rules in sim.pmd.
#   killed_children_test.sh BIN_DIR        in a network namespace of its own (private_network.sh)
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
bin=$(readlink -f "$1")
. tests/procman/background_processes.sh
export LCM_DEFAULT_URL='udpm://239.255.76.67:7695?ttl=0&recv_buf_size=2000000'
export NODMAP_WORLD=sim/worlds/cellar.yaml NODMAP_RUN=$work/run NODMAP_PORT=8765
mkdir "$NODMAP_RUN"

# A line for each command: name, pid, first word of its health, state.
look() {
  "$bin/nodmap-sheriff" procman/sim.pmd --status --json | python3 -c '
import json, sys
for c in json.load(sys.stdin)["commands"]:
    print(c["command"], c["pid"], (c["health"] or "-").replace(":", " ").split()[0], c["state"], c["end"])'
}
field() { awk -v name="$1" -v n="$2" '$1 == name {print $n}'; }

"$bin/nodmap-deputy" procman/sim.pmd >"$work/deputy.log" 2>&1 & pids+=($!)
"$bin/nodmap-sheriff" procman/sim.pmd --script demo --on-script-complete stay >"$work/sheriff.log" 2>&1 & pids+=($!)
until_true grep -q "script demo is done" "$work/sheriff.log"
# Every process runs and its health is OK.
all_well() {
  look >"$work/now.log" &&
    awk '$3 != "OK" || $4 != "Running" {exit 1}' <(grep -v '^sim ' "$work/now.log")
}
"$bin/nodmap-stop" --wait 300 --go
until_true all_well
"$bin/nodmap-stop" --wait 300 || fail "the base driver does not confirm a STOP"
"$bin/nodmap-stop" --wait 300 --go
(LCM_DEFAULT_URL=udpm://239.255.76.67:7999 "$bin/nodmap-stop" --wait 0.2 2>"$work/unconfirmed") && fail "a STOP that nobody receives is no error"
grep -q "no nodmap-kurt has confirmed it" "$work/unconfirmed" || fail "$(cat "$work/unconfirmed")"
for name in kurt laser3d pitch-controller map-server slam2d slam6d navigator explorer logger viewer; do
  cp "$work/now.log" "$work/before"
  kill -KILL "$(field $name 2 <"$work/before")"
  [[ "$name" != kurt && "$name" != navigator ]] || "$bin/nodmap-stop" --wait 300 --go # after their starts the robot is stopped
  until_true all_well
  [[ "$(field $name 2 <"$work/now.log")" != "$(field $name 2 <"$work/before")" ]] || fail "$name was not started anew"
  diff <(cut -d' ' -f1,2 "$work/before" | grep -v "^$name ") <(cut -d' ' -f1,2 "$work/now.log" | grep -v "^$name ") ||
    fail "kill -9 of $name made something else start anew"
  echo "$name: killed, started anew, well"
done
cp "$work/now.log" "$work/before"
kill -STOP "$(field map-server 2 <"$work/now.log")"
until_true grep -q "restarting map-server: no STATUS for" "$work/sheriff.log"
until_true all_well
[[ "$(field map-server 2 <"$work/now.log")" != "$(field map-server 2 <"$work/before")" ]] || fail "map-server was not started anew"
echo "map-server: $(grep '^restarting map-server' "$work/sheriff.log"), well"
grep '^restarting' "$work/sheriff.log" | grep -v map-server && fail "something else was restarted"
kill -KILL "$(field sim 2 <"$work/now.log")"
look >"$work/now.log"
grep -q '^sim 0 - Stopped (Error) killed by signal 9' "$work/now.log" || { cat "$work/now.log"; fail "the end of the simulator is not told"; }
echo "sim: killed, and told so"
