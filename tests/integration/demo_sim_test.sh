#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The demo in the simulator. However it ends, it leaves no process behind.
#   demo_sim_test.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
bin=$1
. tests/support/until_true.sh
[[ "$(readlink -f build/release/bin)" == "$(readlink -f "$bin")" ]] || { echo "skipped: the demo runs what is in build/release/bin"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LCM_DEFAULT_URL
fail() { tail -n 20 "$work"/*.log; echo "FAILED: $*"; exit 1; }

# Every process of a demo has the demo's folder in its environment.
left_over() { grep -lsz "^NODMAP_RUN=$1\$" /proc/[0-9]*/environ 2>/dev/null | cut -d/ -f3; }
expect_nothing_left() {
  local pid left
  left=$(left_over "$1") || true
  for pid in $left; do tr '\0' ' ' <"/proc/$pid/cmdline" 2>/dev/null && echo; done
  [[ -z "$left" ]] || fail "$2 leaves processes behind"
}
# start_demo NAME DURATION [OPTION]: starts it as a terminal would, in a process group of its own, and Ctrl-C goes to all of the group. Until the script
# itself runs, the signal would have no effect: a process that a shell starts in the background ignores it.
start_demo() {
  out=$work/$1
  setsid env --default-signal=INT,HUP bash scripts/demo_sim.sh --duration "$2" --out "$out" "${@:3}" >"$out.log" 2>&1 &
  demo=$!
  until_true is_itself
}
is_itself() { [[ "$(tr '\0' ' ' <"/proc/$demo/cmdline")" == "bash scripts/demo_sim.sh "* ]]; }
# wait_for TEXT: waits until the demo has printed this text.
wait_for() { until_true grep -q "$1" "$out.log"; }
# expect_an_end WHAT: the demo ends and leaves no process behind.
expect_an_end() {
  code=0
  wait "$demo" 2>/dev/null || code=$?
  expect_nothing_left "$out" "$1"
  echo "after $1: exit code $code, nothing left"
}
expect_a_failure() {
  expect_an_end "$1"
  [[ $code -ne 0 ]] || fail "after $1 the demo says that it worked"
}
# find_process PATTERN: the process of this demo, and no other, whose command line is like this, becomes $found.
find_process() {
  for found in $(left_over "$out"); do
    # shellcheck disable=SC2053  # a pattern
    [[ "$(tr '\0' ' ' <"/proc/$found/cmdline")" == $1 ]] && return
  done
  return 1
}
# kill_process PATTERN: kills it as soon as there is one.
kill_process() {
  until_true find_process "$1"
  kill -KILL "$found"
}
kill_sheriff() { kill_process "*/nodmap-sheriff*--script*"; }

# The page named in its first lines can be loaded.
page_answers() {
  local address
  address=$(grep -o -m 1 'http://[^ ]*/' "$1") || return 1
  python3 -c 'import sys, urllib.request as r; sys.exit(b"<title>nodmap" not in r.urlopen(sys.argv[1], timeout=5).read())' "$address" 2>/dev/null
}

out=$work/done
scripts/demo_sim.sh --duration 20 --out "$out" >"$out.log" 2>&1 &
demo=$!
while ! page_answers "$work/done.log" && kill -0 "$demo" 2>/dev/null; do sleep 0.1; done
page_answers "$work/done.log" || fail "the demo's page does not answer"
# On the bus of a robot nothing else starts, neither a second one nor a recording; the robot is not disturbed.
wait_for "driving for"
printf '\xed\xa1\xda\x01' >"$work/recording"
for second in "demo_sim.sh --duration 1" "demo_recording.sh $work/recording"; do
  code=0
  # shellcheck disable=SC2086  # a command line
  scripts/$second --out "$work/second" >"$work/second.log" 2>&1 || code=$?
  [[ $code -eq 1 && ! -e "$work/second" ]] && grep -q "Others send .*STATUS" "$work/second.log" ||
    fail "$second starts beside a robot"
done
wait "$demo" || fail "the demo failed"
# Of 75 scans a second a busy machine may lose a few.
python3 -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["scans"] < 0.8 * 75 * 20)' "$out/watch.json" ||
  fail "the demo ended early"
grep -q '/#token=' "$work/done.log" || fail "the demo does not name its controls"
expect_nothing_left "$work/done" "the demo"
# The commands that it prints at the end can be copied: they name its own programs and its own recording.
again=$(sed -n 's/^to see it again: \(.*\), and a browser on.*/\1/p' "$work/done.log")
[[ "$again" == "build/release/bin/nodmap-viewer --replay $work/done/logger/lcmlog-"* ]] || fail "the demo does not name how to replay it"
# shellcheck disable=SC2086  # a command line
$again --port 0 >"$work/again.log" 2>&1 &
viewer=$!
until_true grep -q "page on http" "$work/again.log"
kill "$viewer" && wait "$viewer" || true

# Played to the demo, its log gives the measurements alone: no commands, and nothing of the processes that ran then.
log=$(echo "$work"/done/logger/lcmlog-*)
scripts/demo_recording.sh "$log" --speed 4 --out "$work/played" >"$work/played.log" 2>&1 || fail "its log is not played"
channels() { "$bin/nodmap-convert" info "$1" | awk '{print $1}'; }
channels "$log" >"$work/recorded"
channels "$work"/played/logger/lcmlog-* >"$work/channels"
for channel in SCAN ODOMETRY PITCH_STATE BASE_SENSORS; do grep -qx $channel "$work/channels" || fail "$channel is not played"; done
for channel in STOP DRIVE NAVIGATION PM_ORDERS; do
  grep -qx $channel "$work/recorded" || fail "the demo's log has no $channel"
  ! grep -qx $channel "$work/channels" || fail "$channel of the recorded robot is played"
done

# Ctrl-C at the moment when a command of the script ends by itself.
mkdir "$work/stub"
printf '#!/bin/sh\n/bin/mkdir "$@"\nkill -INT "$PPID"\n' >"$work/stub/mkdir"
chmod +x "$work/stub/mkdir"
code=0
PATH=$work/stub:$PATH env --default-signal=INT bash scripts/demo_sim.sh --duration 1 --out "$work/at-the-end-of-a-command" >"$work/log" 2>&1 || code=$?
[[ $code -eq 130 ]] || fail "a Ctrl-C as a command of the script ends has no effect: exit code $code"

# It listens for two seconds first.
for seconds in 0 1 2.3 3 4 6 9; do
  start_demo "interrupted-$seconds" 30
  sleep "$seconds"
  kill -INT -- "-$demo" 2>/dev/null || fail "the demo has ended by itself within $seconds s"
  expect_a_failure "Ctrl-C at $seconds s"
done
for seconds in 0 1 2; do
  start_demo "interrupted-at-the-end-$seconds" 1
  wait_for "stopping the processes"
  sleep "$seconds"
  kill -INT -- "-$demo" 2>/dev/null || true  # it may have ended already
  expect_an_end "Ctrl-C $seconds s into stopping"
done
for signal in HUP TERM; do
  start_demo "ended-by-$signal" 30
  wait_for "driving for"
  kill "-$signal" "$demo"
  expect_a_failure "SIG$signal"
done

# Time for the robot to start, not to come home.
start_demo not-home 5 --explore
expect_a_failure "an exploration that is too short"
grep -q "m driven" "$out.log" || fail "an exploration that is too short is not summarised"

start_demo nowhere 5 --world officce:1
expect_a_failure "a scenario that does not exist"
grep -q "officce:1: no such scenario" "$out.log" || fail "the demo does not say why it did not start"

start_demo beheaded-at-the-start 30
wait_for "starting the processes"
kill_sheriff
expect_a_failure "kill -9 of the sheriff that starts"
start_demo beheaded-at-the-end 1
wait_for "stopping the processes"
kill_sheriff
expect_a_failure "kill -9 of the sheriff that stops"

# As it also ends by itself where another deputy has its name; no sheriff may then give that one orders.
start_demo without-deputy 5
wait_for "driving for"
kill_process "*/nodmap-deputy*"
expect_a_failure "kill -9 of the deputy"
grep -q "the deputy has ended" "$out.log" && ! grep -q "stopping the processes" "$out.log" || fail "the demo goes on without its deputy"

# Then nobody waits for the end of processes that end by themselves.
start_demo killed 30
wait_for "driving for"
until_true find_process "*/nodmap-watch *"  # the last one, which is past the moment between fork and setpriv
kill -KILL "$demo"
wait "$demo" 2>/dev/null || true
nothing_is_left() { [[ -z "$(left_over "$out")" ]]; }
until_true nothing_is_left
expect_nothing_left "$out" "kill -9 of the demo"
echo "nothing is left behind"
