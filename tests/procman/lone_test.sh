#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# nodmap-sheriff --lone: one command starts deputy, sheriff and script; Ctrl-C, SIGTERM and kill -9 end all of them. Also: a sheriff that starts
# later shows the output of a command that has already ended.
#   lone_test.sh BIN_DIR
set -euo pipefail
bin=$1
. "$(dirname "$(readlink -f "$0")")/../support/until_true.sh"
work=$(mktemp -d)
# Nothing is left running, also when the test fails.
trap 'jobs -p | xargs -r kill 2>/dev/null || true; wait; rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; cat "$work"/*.log 2>/dev/null; exit 1; }
export NODMAP_LONE=$work
cat >"$work/a.pmd" <<'PMD'
cmd "sleeper" { exec = "sleep 1000"; deputy = "here";
  #nodmap: nice = 7;
}
cmd "failing" { exec = "ls /no/such/file"; deputy = "here"; }
script "up" { start cmd "sleeper" wait "running"; }
script "fail" { start cmd "failing"; }
script "half" { start cmd "failing"; start cmd "sleeper" wait "running"; }
script "endless" { restart cmd "sleeper" wait "stopped"; }
PMD

# The pids of this test's processes with this command line; some may end meanwhile.
mine() { { grep -lsz "^NODMAP_LONE=$work\$" /proc/[0-9]*/environ | cut -d/ -f3 | while read -r pid; do
  [[ "$(tr '\0' ' ' <"/proc/$pid/cmdline")" == $1 ]] && echo "$pid"
done; } 2>/dev/null || true; }
sleeper() { mine "sleep 1000 "; }
left_over() { sleeper; mine "*/nodmap-*"; }
is_up() { [[ -n "$(sleeper)" ]]; }
is_asleep_no_more() { [[ -z "$(sleeper)" ]]; }
is_gone() { [[ -z "$(left_over)" ]]; }

for signal in INT TERM KILL; do
  setsid env --default-signal=INT "$bin/nodmap-sheriff" "$work/a.pmd" --lone --script up --on-script-complete stay >"$work/$signal.log" 2>&1 &
  sheriff=$!
  until_true is_up
  nice=$(ps -o ni= -p "$(sleeper)" | tr -d ' ')
  [[ "$nice" -ge 7 ]] || fail "the priority is $nice"
  until_true grep -q "script up is done" "$work/$signal.log"
  code=0
  kill -"$signal" "$sheriff"
  wait "$sheriff" 2>/dev/null || code=$?
  until_true is_gone
  [[ $signal == KILL || $code -eq 0 ]] || fail "exit code $code after SIG$signal"
  echo "SIG$signal: everything has ended"
done

# The deputies end also if they were started only just before, and a script that does not exist is said to be missing.
for _ in $(seq 20); do
  code=0
  timeout --signal=KILL 10 "$bin/nodmap-sheriff" "$work/a.pmd" --lone --script pu >"$work/typo.log" 2>&1 || code=$?
  [[ $code -eq 2 ]] && grep -q 'has no script "pu"' "$work/typo.log" || fail "exit code $code after a script that does not exist"
done
until_true is_gone
echo "a script that does not exist ends a lone sheriff"

"$bin/nodmap-deputy" "$work/a.pmd" --id here 2>"$work/deputy.log" &
deputy=$!
until_true grep -q serving "$work/deputy.log"
# A sheriff that stays repeats its orders to a deputy that was killed and started again.
"$bin/nodmap-sheriff" "$work/a.pmd" --script up --on-script-complete stay >"$work/stay.log" 2>&1 &
sheriff=$!
until_true grep -q "script up is done" "$work/stay.log"
kill -KILL "$deputy"
wait "$deputy" 2>/dev/null || true
until_true is_asleep_no_more
"$bin/nodmap-deputy" "$work/a.pmd" --id here 2>"$work/deputy.log" &
deputy=$!
until_true is_up
kill -TERM "$sheriff"
wait "$sheriff" || true
echo "a killed deputy takes up its commands again"

# nodmap-robot.service runs its stop script only if its sheriff ends with exit code 0 when it is stopped.
for stop in "half has failed" "endless sleeper: Restarting"; do
  read -r script said <<<"$stop"
  "$bin/nodmap-sheriff" "$work/a.pmd" --script "$script" --on-script-complete stay >"$work/$script.log" 2>&1 &
  sheriff=$!
  until_true grep -q "$said" "$work/$script.log"
  kill -TERM "$sheriff"
  wait "$sheriff" || fail "a sheriff that is stopped after '$said' ends with exit code $?"
done
echo "a sheriff that was to stay ends well when it is stopped, whatever became of its script"

"$bin/nodmap-sheriff" "$work/a.pmd" --script fail --on-script-complete exit --timeout 20 >"$work/fail.log" 2>&1 && fail "a failing command is no failure"
# The command wrote its output when nobody was listening.
"$bin/nodmap-sheriff" "$work/a.pmd" --output failing >"$work/output.log" 2>&1 &
listener=$!
until_true grep -q "/no/such/file" "$work/output.log"
kill -TERM "$listener"
wait "$listener" || true
grep -q "failing: .*/no/such/file" "$work/deputy.log" || fail "the deputy's log has not the last words"
kill -TERM "$deputy"
wait "$deputy" || fail "the deputy does not end well"
echo "the last words are received later, and are in the log"
