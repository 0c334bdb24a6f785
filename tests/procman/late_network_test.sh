#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A host whose network comes late. Without a multicast route, deputy and sheriff end with exit code 1, after which their units start them again
# for as long as it takes; with the route they run.
#   late_network_test.sh BIN_DIR        in a network namespace of its own (private_network.sh)
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
bin=$(readlink -f "$1")
. tests/support/until_true.sh
work=$(mktemp -d)
supervisor=
# Nothing is left running, also when the test fails.
trap '[[ -z "$supervisor" ]] || kill "$supervisor" 2>/dev/null || true; rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; cat "$work"/log 2>/dev/null; exit 1; }
echo 'cmd "sleeper" { exec = "sleep 1000"; deputy = "here"; } script "up" { start cmd "sleeper" wait "running"; }' >"$work/a.pmd"

for unit in procman/systemd/nodmap-deputy.service procman/systemd/nodmap-robot.service; do
  for line in StartLimitIntervalSec=0 Restart=on-failure RestartPreventExitStatus=2; do
    grep -qx "$line" "$unit" || fail "$unit lacks $line"
  done
done

# As systemd does: starts it again after each failure, unless it ends with exit code 2. If this is killed, the deputy ends as well.
deputy() {
  local code=1
  while [[ $code -eq 1 ]]; do
    echo start
    code=0
    setpriv --pdeathsig TERM "$bin/nodmap-deputy" "$work/a.pmd" || code=$?
    sleep 0.2
  done
  return "$code"
}
ip route del 224.0.0.0/4 dev lo
deputy >"$work/log" 2>&1 &
supervisor=$!
# More often than systemd's own limit of five.
was_started_often() { [[ $(grep -c '^start$' "$work/log") -gt 6 ]]; }
until_true was_started_often
code=0
"$bin/nodmap-sheriff" "$work/a.pmd" --script up --on-script-complete stay >"$work/sheriff.log" 2>&1 || code=$?
[[ $code -eq 1 ]] || fail "without a network the sheriff ends with $code"

ip route add 224.0.0.0/4 dev lo
"$bin/nodmap-sheriff" "$work/a.pmd" --script up --on-script-complete exit --timeout 300 >"$work/sheriff.log" 2>&1 ||
  { cat "$work/sheriff.log"; fail "with a network nothing starts"; }
pkill -TERM -P "$supervisor" nodmap-deputy
wait "$supervisor" || fail "the deputy does not end well"
supervisor=
echo "a late network is waited for"
