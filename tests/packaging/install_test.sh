#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs into a folder, moves the folder, and uses it from there: the programs run, and another project finds the types.
#   install_test.sh BUILD_DIR
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/moved"
"$work/moved/bin/nodmap-sheriff" "$work/moved/share/nodmap/procman/robot.pmd" --check
cmake -S consumer -B "$work/consumer" -Dnodmap_DIR="$work/moved/lib/cmake/nodmap" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --build "$work/consumer" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
"$work/consumer/consumer"
