# SPDX-License-Identifier: BSD-3-Clause
# Sourced. How the scripts speak; $speaker is who does.

# Colours are for terminals: in a file they are noise.
say() { if [[ -t 1 ]]; then printf '\033[1m==> %s\033[0m\n' "$*"; else printf '==> %s\n' "$*"; fi; }
die() { printf '%s: %s\n' "$speaker" "$*" >&2; exit 1; }
