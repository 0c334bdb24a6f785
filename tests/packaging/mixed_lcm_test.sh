#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Headers of one LCM and the generator of another: said by CMake, not by the compiler.
#   mixed_lcm_test.sh SOURCE_DIR
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '#!/bin/sh\necho lcm-gen 99.1.0\n' >"$work/lcm-gen"
chmod +x "$work/lcm-gen"
if cmake -S "$1" -B "$work/build" -DNODMAP_LCM_GEN="$work/lcm-gen" >"$work/log" 2>&1; then
  echo "FAILED: a mixed LCM is configured"
  exit 1
fi
grep -q "two installations of LCM" "$work/log" || { cat "$work/log"; echo "FAILED: not said why"; exit 1; }
