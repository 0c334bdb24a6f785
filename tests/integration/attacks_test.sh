#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The whole robot live while messages and datagrams are forged, a few seconds for each attack: nothing is hit, nothing dies, the robot stands
# or drives on as SAFETY.md says, and STATUS tells.
#   attacks_test.sh BENCH_LIVE WORLD        in a network of its own (private_network.sh)
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$1" --world "$2" --out "$work/live" attacks --duration 5
