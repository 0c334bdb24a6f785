#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How ./nodmap demo treats its arguments, before it builds or starts anything; how it shows a build; no colours in files.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }

# expect CODE TEXT ARGUMENT...
expect() {
  local code=0 wanted=$1 text=$2
  shift 2
  timeout 60 ./nodmap demo "$@" >"$work/out" 2>&1 || code=$?
  [[ $code -eq $wanted ]] || { cat "$work/out"; fail "demo $*: code $code, not $wanted"; }
  grep -qF -- "$text" "$work/out" || { cat "$work/out"; fail "demo $*: does not say '$text'"; }
}
expect 0 "--duration SECONDS" --help
expect 0 "--speed FACTOR" some.clf --help
expect 0 "$(sed -n 's/^project(nodmap VERSION \([^ ]*\).*/\1/p' CMakeLists.txt)" --version
expect 2 "--duration: 'abc' is not a number above 0" --duration abc
expect 2 "--duration: '0' is not a number above 0" --duration 0
expect 2 "--duration needs a value" --duration
expect 2 "--world needs a value" --world ""
expect 2 "unknown option --wrold" --wrold x
expect 2 "no.yaml: cannot open: No such file or directory" --world no.yaml
expect 2 "$work exists" --out "$work"
echo "a,b" >"$work/table.csv"
expect 2 "table.csv: is neither a folder" "$work/table.csv"
expect 2 "none.clf: cannot open: No such file or directory" "$work/none.clf"
expect 2 "--speed: 'fast' is not a number above 0" "$work/table.csv" --speed fast
timeout 60 ./nodmap explore --help >"$work/out" || fail "explore --help fails"
grep -qF "sim/worlds/office.yaml" "$work/out" || fail "explore does not say which world"
code=0
timeout 60 ./nodmap explore --duration 0 >"$work/out" 2>&1 || code=$?
[[ $code -eq 2 ]] || fail "explore takes a duration of 0"
code=0
timeout 60 ./nodmap explore x >"$work/out" 2>&1 || code=$?
[[ $code -eq 2 ]] && grep -qF "nodmap explore: unknown option x (see ./nodmap explore --help)" "$work/out" || { cat "$work/out"; fail "explore x: code $code"; }
# Arguments are checked before anything is installed or built.
mkdir "$work/stubs"
for program in cmake sudo apt-get; do
  printf '#!/bin/sh\ntouch %s/started\nexit 9\n' "$work" >"$work/stubs/$program"
  chmod +x "$work/stubs/$program"
done
while read -r wanted command; do
  code=0
  # shellcheck disable=SC2086  # a command line
  PATH=$work/stubs:$PATH timeout 60 ./nodmap $command >"$work/out" 2>&1 || code=$?
  [[ $code -eq $wanted && ! -e "$work/started" ]] || { cat "$work/out"; fail "$command: code $code, not $wanted, or something was begun"; }
  grep -qF "./nodmap ${command%% *}" "$work/out" || { cat "$work/out"; fail "$command: does not say how it is used"; }
done <<'TEXT'
2 bench typo
0 bench --help
2 figures 99
2 figures --jobs many
0 figures --help
TEXT
code=0
timeout 60 ./nodmap bulid >"$work/out" 2>&1 || code=$?
[[ $code -eq 2 ]] && grep -qF "unknown command 'bulid'" "$work/out" || fail "an unknown command is not named: $code"
# A mistyped option does not start what takes hours, or writes documents.
before=$(cat README.md docs/*.md | cksum)
for command in "results --chek" "results --check x" "test x" "test --al" "lint --al" "check x" "build x" "docs x" "format x" "fuzz x" "spy x"; do
  code=0
  # shellcheck disable=SC2086  # a command line
  timeout 60 ./nodmap $command >"$work/out" 2>&1 || code=$?
  [[ $code -eq 2 ]] && grep -qF "unexpected argument: ${command#* }" "$work/out" || { cat "$work/out"; fail "./nodmap $command is not refused: $code"; }
done
for command in "results.py x --chek" "run_clang_tidy.py x --al"; do
  code=0
  # shellcheck disable=SC2086  # a command line
  timeout 60 python3 scripts/$command >"$work/out" 2>&1 || code=$?
  [[ $code -eq 2 ]] || { cat "$work/out"; fail "$command is not refused: $code"; }
done
[[ "$(cat README.md docs/*.md | cksum)" == "$before" ]] || fail "the documents have changed"
# An event log is recognised by its contents.
printf '\xed\xa1\xda\x01' >"$work/recording"
scripts/demo_recording.sh --check-arguments "$work/recording" --out "$work/new"
expect 2 "unknown option --speed (a RECORDING comes before its options)" --speed 2 "$work/recording"
[[ ! -e "$work/new" ]] || fail "a check has made a folder"

# Paths are those of the shell that calls, whatever its folder.
nodmap=$PWD/nodmap
(
  cd "$work"
  for arguments in "recording --out table.csv" "--world recording --out table.csv"; do
    code=0
    # shellcheck disable=SC2086  # a command line
    timeout 60 "$nodmap" demo $arguments >out 2>&1 || code=$?
    [[ $code -eq 2 ]] && grep -qF "$work/table.csv exists" out || { cat out; fail "demo $arguments in another folder: $code"; }
  done
)

said=$(source scripts/demo_common.sh && say hello) || fail "nothing is said"
[[ "$said" == *hello* && "$said" != *$'\033'* ]] || fail "colours in a file, or no text: '$said'"

shown=$(printf '5 20 10.0 Building x\nx.cpp:3: warning\n' | scripts/build_progress.py | tr '\r' '\n')
grep -qF "5 of 20 steps, about 30 s left" <<<"$shown" || fail "no estimate in '$shown'"
grep -qF "x.cpp:3: warning" <<<"$shown" || fail "a message of the compiler is lost"
