#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The demo on the KURT3D recording: every process runs live on LCM, and lcm-logplayer plays the log at real speed. The results must be those of
# --replay, message by message, and no process may be left running.
#   demo_test.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
bin=$1
[[ "$(readlink -f build/release/bin)" == "$(readlink -f "$bin")" ]] || { echo "skipped: the demo runs what is in build/release/bin"; exit 77; }
data=${NODMAP_DATA:-../shared/data}/kurt3d
if [[ ! -d "$data" ]]; then
  echo "missing data: kurt3d (set NODMAP_DATA)"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LCM_DEFAULT_URL

fail() { echo "FAILED: $*"; exit 1; }
# A folder without scans: the demo ends, and nothing of it is left. The pipe ends only when the last process has closed it.
mkdir "$work/empty"
code=0
timeout 60 scripts/demo_recording.sh "$work/empty" --out "$work/none" 2>&1 | cat >"$work/said" || code=$?
[[ $code -eq 2 && ! -e "$work/none" ]] || { cat "$work/said"; fail "an empty folder: code $code"; }

scripts/demo_recording.sh "$data" --out "$work/demo"

for module in slam2d slam6d; do
  "$bin/nodmap-$module" --replay "$work/demo/recording.lcmlog" --out "$work/$module"
  cmp "$work/demo/$module/trajectory.tum" "$work/$module/trajectory.tum" || fail "$module: live and replay differ"
  cmp "$work/demo/$module/online.tum" "$work/$module/online.tum" || fail "$module: live and replay differ online"
done
convert_octree "$work/demo/slam6d/map.bt" "$work/map.ot" || fail "stock OctoMap does not load map.bt"
# The log of the run contains every scan that was played.
scans() { "$bin/nodmap-convert" info "$1" | awk '$1 == "SCAN" {print $3}'; }
played=$(scans "$work/demo/recording.lcmlog")
logged=$(scans "$(ls "$work"/demo/logger/lcmlog-*)")
[[ -n "$played" && "$played" == "$logged" ]] || fail "$played scans were played, $logged were logged"
pgrep -f -- "--out $work/demo" && fail "processes are left running"
echo "live equals replay, $played scans"
