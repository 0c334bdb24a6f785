# SPDX-License-Identifier: BSD-3-Clause
# Sourced. What the demos say, and how they take their arguments. $what is the command: demo or explore.

speaker="nodmap ${what-demo}"
source scripts/say.sh
usage_error() { printf '%s: %s (see ./%s --help)\n' "$speaker" "$*" "$speaker" >&2; exit 2; }

print_version() { sed -n 's/^project(nodmap VERSION \([^ ]*\).*/\1/p' CMakeLists.txt; }

# need_number OPTION VALUE: a number above 0.
need_number() {
  [[ "$2" =~ ^[0-9]+(\.[0-9]+)?$ && "$2" =~ [1-9] ]] || usage_error "$1: '$2' is not a number above 0"
}
# need_value OPTION [VALUE] ...
need_value() { [[ -n "${2-}" ]] || usage_error "$1 needs a value"; }
# from_caller VARIABLE PATH: sets it to the path as the shell means it that called ./nodmap, perhaps in another folder.
from_caller() { [[ "$2" == /* ]] && printf -v "$1" %s "$2" || printf -v "$1" %s "$NODMAP_CALLER/$2"; }
# need_new FOLDER: results are never overwritten.
need_new() { [[ ! -e "$1" ]] || usage_error "$1 exists; results are never overwritten"; }
