#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Forges messages and datagrams while the whole robot runs live, a few seconds for each attack: the robot hits nothing, no process ends, the
# robot halts or drives on as SAFETY.md says, and STATUS reports the attack.
#   attacks_test.sh BENCH_LIVE WORLD        in a network namespace of its own (private_network.sh)
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$1" --world "$2" --out "$work/live" attacks --duration 5
