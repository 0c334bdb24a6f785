#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The demo in the simulator, and that it leaves no process behind however it ends.
#   demo_sim_test.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
bin=$1
[[ "$(readlink -f build/release/bin)" == "$(readlink -f "$bin")" ]] || { echo "skipped: the demo runs what is in build/release/bin"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LCM_DEFAULT_URL
fail() { echo "FAILED: $*"; exit 1; }

# Every process of a demo has its folder in the environment.
left_over() { grep -lsz "^NODMAP_RUN=$1\$" /proc/[0-9]*/environ 2>/dev/null | cut -d/ -f3; }
expect_nothing_left() {
  local pid left
  left=$(left_over "$1") || true
  for pid in $left; do tr '\0' ' ' <"/proc/$pid/cmdline" 2>/dev/null && echo; done
  [[ -z "$left" ]] || fail "$2 leaves processes behind"
}
# As a terminal would: a process group of its own, and Ctrl-C to all of it.
start_demo() {
  setsid env --default-signal=INT tools/demo_sim.sh --duration 30 --out "$1" >"$1.log" 2>&1 &
  demo=$!
}

tools/demo_sim.sh --duration 10 --out "$work/done" || fail "the demo failed"
expect_nothing_left "$work/done" "the demo"

for seconds in 0.1 0.6 1.5 3 5 8; do
  start_demo "$work/interrupted-$seconds"
  sleep "$seconds"
  kill -INT -- "-$demo"
  code=0
  wait "$demo" || code=$?
  [[ $code -ne 0 ]] || fail "interrupted after $seconds s, the demo says that it worked"
  expect_nothing_left "$work/interrupted-$seconds" "Ctrl-C after $seconds s"
done

start_demo "$work/beheaded"
for _ in $(seq 100); do pkill -KILL -f "nodmap-sheriff procman/sim.pmd --script demo" && break; sleep 0.05; done
code=0
wait "$demo" || code=$?
[[ $code -ne 0 ]] || fail "without a sheriff the demo says that it worked"
expect_nothing_left "$work/beheaded" "kill -9 of the sheriff"
echo "nothing is left behind"
