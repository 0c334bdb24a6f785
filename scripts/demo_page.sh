# SPDX-License-Identifier: BSD-3-Clause
# Sourced. The demo's page: its port, the door to it where the demo runs in a network of its own, and a browser.

# Says where the page will be, on $NODMAP_PORT.
name_page() {
  if [[ -n "${NODMAP_DOOR:-}" ]]; then
    python3 scripts/page_door.py guard $$ &
    exec {NODMAP_DOOR}>&-
    unset NODMAP_DOOR
  else
    NODMAP_PORT=$(python3 scripts/page_door.py port)
    export NODMAP_PORT
  fi
  say "the robot in your browser: http://127.0.0.1:$NODMAP_PORT/"
}

# open_page [FRAGMENT]: shows it where there is a screen.
open_page() {
  if [[ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]] && command -v xdg-open >/dev/null; then
    xdg-open "http://127.0.0.1:$NODMAP_PORT/${1:-}" >/dev/null 2>&1 &
  fi
}
