#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The whole robot in a simulated building, every process by the process manager. Called by ./nodmap demo and ./nodmap explore.
#   scripts/demo_sim.sh [--check-arguments] [--explore] [--world WORLD] [--duration SECONDS] [--out DIR]
set -euo pipefail
# First of all: without a trap bash goes on after a Ctrl-C if the command that it waits for has just ended by itself. With one, seldom, if it waits for a
# $(command): until results can be left behind, nothing here does.
trap 'exit 130' INT
export NODMAP_CALLER=${NODMAP_CALLER:-$PWD}
cd -P "${0%/*}/.."
bin=$PWD/build/release/bin
config=procman/sim.pmd
what=demo world=sim/worlds/cellar.yaml duration=60
if [[ " $* " == *" --explore "* ]]; then
  what=explore world=sim/worlds/office.yaml duration=900
fi
source scripts/demo_common.sh

usage() {
  cat <<'TEXT'
usage: ./nodmap demo [--world WORLD] [--duration SECONDS] [--out DIR]
       ./nodmap demo RECORDING ...    runs on a recording: ./nodmap demo RECORDING --help

Drives the robot through a simulated building, every process as on the robot, and maps it.

  --world WORLD       the building: a file, or SCENARIO:SEED (sim/worlds/cellar.yaml)
  --duration SECONDS  how long it drives (60)
  --out DIR           a new folder for the results (logs/demo-DATE-TIME)
  --version           print the version
TEXT
}
usage_explore() {
  cat <<'TEXT'
usage: ./nodmap explore [--world WORLD] [--duration SECONDS] [--out DIR]

Lets the robot explore a simulated building, every process as on the robot: it drives until its 2D map shows all that it
can reach, and back to where it began.

  --world WORLD       the building: a file, or SCENARIO:SEED (sim/worlds/office.yaml)
  --duration SECONDS  the longest time (900)
  --out DIR           a new folder for the results (logs/explore-DATE-TIME)
  --version           print the version
TEXT
}

arguments=("$@")
check_only=0
printf -v out 'logs/%s-%(%Y%m%d-%H%M%S)T' "$what" -1
while [[ $# -gt 0 ]]; do
  case "$1" in
    --check-arguments) check_only=1; shift ;;
    --explore) shift ;;
    --help | -h) [[ $what == demo ]] && usage || usage_explore; exit 0 ;;
    --version) print_version; exit 0 ;;
    --world) need_value "$@"; [[ "$2" == *:* ]] && world=$2 || from_caller world "$2"; shift 2 ;;
    --duration) need_value "$@"; need_number "$1" "$2"; duration=$2; shift 2 ;;
    --out) need_value "$@"; from_caller out "$2"; shift 2 ;;
    *) [[ $what == demo ]] && usage_error "unknown option $1 (a RECORDING comes before its options)" || usage_error "unknown option $1" ;;
  esac
done
[[ "$world" == *:* || -f "$world" ]] || usage_error "$world: cannot open: No such file or directory"
need_new "$out"
[[ $check_only -eq 0 ]] || exit 0
source scripts/private_net.sh
source scripts/demo_page.sh
need_multicast "$0" "${arguments[@]}"

mkdir -p "$out"
out=$(readlink -f "$out")
name_page
# sim.pmd names these and NODMAP_PORT; the deputy puts them in.
export NODMAP_WORLD=$world NODMAP_RUN=$out

deputy='' listener='' running=''
end_deputy() {
  # Waited for, too: nothing is left when this has ended.
  if [[ -n "$running" ]]; then
    kill -TERM "$running" 2>/dev/null || true
    wait "$running" || true
    running=
  fi
  if [[ -n "$listener" ]]; then
    kill "$listener" 2>/dev/null || true
    wait "$listener" || true
    listener=
  fi
  [[ -n "$deputy" ]] || return 0
  local code=0
  kill -TERM "$deputy" 2>/dev/null || true
  wait "$deputy" || code=$?
  deputy=
  return $code
}
# However this ends, the deputy ends, and with it whatever it has started; also (setpriv) when this is killed.
trap 'trap - EXIT INT TERM HUP; end_deputy || true; exit 130' INT TERM HUP
trap 'trap - EXIT INT TERM HUP; end_deputy' EXIT

# Waited for in the background: a trap runs at once then, and not after the command.
run() {
  local code=0
  setpriv --pdeathsig TERM "$@" &
  running=$!
  wait "$running" || code=$?
  running=
  return $code
}

# A sheriff's script would also start and stop the processes of another deputy of this name, which makes ours end.
need_deputy() { kill -0 "$deputy" 2>/dev/null || die "the deputy has ended; see $out/deputy.log"; }

say "starting the processes (LCM: $LCM_DEFAULT_URL)"
setpriv --pdeathsig TERM "$bin/nodmap-deputy" "$config" >"$out/deputy.log" 2>&1 &
deputy=$!
run "$bin/nodmap-sheriff" "$config" --script demo --on-script-complete exit --timeout 30 >"$out/sheriff.log" || {
  # The deputy warns with what a process said before it failed.
  sed -n 's/^[0-9:.]* nodmap-deputy warning: //p' "$out/deputy.log" | tail -n 5 >&2
  die "not every process started; see $out/sheriff.log and $out/deputy.log"
}

need_deputy
# The viewer says the token of the page by its output, and the deputy hands that on.
setpriv --pdeathsig TERM "$bin/nodmap-sheriff" "$config" --output viewer >"$out/viewer.log" 2>&1 &
listener=$!

# After each start the base driver keeps the robot stopped until somebody releases it.
run "$bin/nodmap-stop" --go --wait 30 --by demo || die "the robot is not released; see $out/deputy.log"

token=
for ((tries = 0; tries < 50; ++tries)); do
  token=$(grep -o -m 1 '#token=[0-9a-f]*' "$out/viewer.log") && break
  sleep 0.1
done
if [[ -n "$token" ]]; then
  say "the same with the controls: http://127.0.0.1:$NODMAP_PORT/$token"
fi
open_page "$token"
watch=(--duration "$duration" --json "$out/watch.json")
if [[ $what == explore ]]; then
  run "$bin/nodmap-explore" --by "./nodmap explore" || die "the explorer does not answer; see $out/deputy.log"
  say "exploring $world, for $duration s at most"
  watch+=(--until-home)
else
  say "driving for $duration s in $world"
fi
watched=0
run "$bin/nodmap-watch" "${watch[@]}" || watched=$?

need_deputy
say "stopping the processes"
run "$bin/nodmap-sheriff" "$config" --script stop_all --on-script-complete exit --timeout 60 >>"$out/sheriff.log" || die "not every process stopped; see $out/sheriff.log"
"$bin/nodmap-sheriff" "$config" --status --json >"$out/status.json" || true
end_deputy || die "the deputy did not end cleanly; see $out/deputy.log"
code=0
if [[ $watched -ne 0 ]]; then
  ! grep -q '"scans": 0,' "$out/watch.json" || die "no scan came"
  say "the robot has not come back home"
  code=1
fi
python3 scripts/demo_summary.py sim "$out" || code=1
exit $code
