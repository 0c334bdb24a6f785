#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# With the headers of one LCM and the generator of another, CMake (and not only the compiler) reports an error. Parts of the same LCM are found
# together.
#   mixed_lcm_test.sh SOURCE_DIR
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { cat "$work/log"; echo "FAILED: $*"; exit 1; }

# An LCM 99.1, laid out as LCM installs itself since 1.4: PREFIX/lib/lcm/cmake, and its generator in PREFIX/bin.
prefix=$work/lcm99
package=$prefix/lib/lcm/cmake
mkdir -p "$package" "$prefix/bin"
echo 'add_library(lcm INTERFACE IMPORTED)' >"$package/lcmConfig.cmake"
printf 'set(PACKAGE_VERSION 99.1.0)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n' >"$package/lcmConfigVersion.cmake"
printf '#!/bin/sh\necho lcm-gen 99.1.0\n' >"$work/lcm-gen"
chmod +x "$work/lcm-gen"

# configure ARGUMENT ...: in a fresh folder, as a user whose CMake registry contains only what is in $work/home
mkdir "$work/home"
configure() {
  rm -rf "$work/build"
  HOME=$work/home cmake -S "$source" -B "$work/build" -DNODMAP_TESTS=OFF -DNODMAP_BENCH=OFF "$@" >"$work/log" 2>&1
}
found() { grep -q "^NODMAP_LCM_GEN:FILEPATH=$1\$" "$work/build/CMakeCache.txt" || fail "the generator is not $1"; }

# CMake breaks lines anywhere.
is_told() { tr -s '\n ' ' ' <"$work/log" | grep -q "two installations of LCM are mixed"; }
configure -DNODMAP_LCM_GEN="$work/lcm-gen" && fail "another generator is taken"
is_told || fail "not said why, of another generator"
configure -Dlcm_DIR="$package" -DNODMAP_LCM_GEN="$(command -v lcm-gen)" && fail "other headers are taken"
is_told || fail "not said why, of other headers"

cp "$work/lcm-gen" "$prefix/bin"
configure -Dlcm_DIR="$package" || fail "a whole LCM is refused"
found "$prefix/bin/lcm-gen"

# A build folder of LCM, as `cmake` in LCM's sources registers it for the user.
mkdir -p "$work/home/.cmake/packages/lcm"
echo "$package" >"$work/home/.cmake/packages/lcm/0123456789abcdef0123456789abcdef"
configure || fail "a build folder of LCM disturbs"
found "$(command -v lcm-gen)"
