# SPDX-License-Identifier: BSD-3-Clause
# Sourced. A machine without a multicast route (a container, say) cannot carry LCM; a network namespace of our own can.
#   need_multicast SCRIPT [ARGUMENT ...]   returns where there is a route, else runs the script anew in such a namespace
export LCM_DEFAULT_URL=${LCM_DEFAULT_URL:-udpm://239.255.76.67:7667?ttl=0}
need_multicast() {
  if [[ "${NODMAP_PRIVATE_NET:-}" == 1 ]] || ip route get 239.255.76.67 >/dev/null 2>&1; then
    return
  fi
  unshare -rn true 2>/dev/null || die "there is no multicast route for LCM; nodmap-doctor says how to add one"
  say "no multicast route here: running in a network namespace of our own"
  exec env NODMAP_PRIVATE_NET=1 python3 tools/page_door.py open unshare -rn sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "$@"
}

# name_page: says where the page of this demo is, on $NODMAP_PORT, and keeps the door to it open.
name_page() {
  if [[ -n "${NODMAP_DOOR:-}" ]]; then
    python3 tools/page_door.py guard &
    exec {NODMAP_DOOR}>&-
    unset NODMAP_DOOR
  else
    NODMAP_PORT=$(python3 tools/page_door.py port)
    export NODMAP_PORT
  fi
  say "the robot in your browser: http://127.0.0.1:$NODMAP_PORT/"
}

# open_page: shows it where there is a screen.
open_page() {
  if [[ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]] && command -v xdg-open >/dev/null; then
    xdg-open "http://127.0.0.1:$NODMAP_PORT/" >/dev/null 2>&1 &
  fi
}
