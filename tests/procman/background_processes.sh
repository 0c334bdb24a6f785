# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# To be sourced by a test: a folder $work for its files, and $pids, the processes that it has started in the background. Whether the test passes
# or fails, at its end they are stopped and the folder is removed.
work=$(mktemp -d)
pids=()
end() {
  trap - EXIT
  local pid
  for pid in "${pids[@]}"; do kill -TERM "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap end EXIT
. tests/support/until_true.sh
fail() { echo "FAILED: $*"; tail -n 20 "$work"/*.log; exit 1; }
