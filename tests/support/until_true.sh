# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# To be sourced by a test that has a function `fail`.
# until_true COMMAND ...: repeats the command until it succeeds. On a busy machine everything has taken five times as long as usual, so only what
# has not come after ten minutes counts as what never comes.
until_true() {
  local end=$((SECONDS + 600))
  until "$@"; do
    [[ $SECONDS -lt $end ]] || fail "never: $*"
    sleep 0.1
  done
}
