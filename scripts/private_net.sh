# SPDX-License-Identifier: BSD-3-Clause
# Sourced. A machine without a multicast route (a container, say) cannot carry LCM; a network namespace of our own can.
#   need_multicast SCRIPT [ARGUMENT ...]   returns where there is a route, else runs the script anew in such a namespace
export LCM_DEFAULT_URL=${LCM_DEFAULT_URL:-udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304}
need_multicast() {
  if [[ "${NODMAP_PRIVATE_NET:-}" == 1 ]] || ip route get 239.255.76.67 >/dev/null 2>&1; then
    return
  fi
  # Root needs no user namespace (-r), which would take away the right to real-time priority.
  local new_network=(unshare -n)
  "${new_network[@]}" true 2>/dev/null || new_network=(unshare -rn)
  "${new_network[@]}" true 2>/dev/null || die "there is no multicast route for LCM; nodmap-doctor says how to add one"
  say "no multicast route here: running in a network namespace of our own"
  exec env NODMAP_PRIVATE_NET=1 python3 scripts/page_door.py open "${new_network[@]}" sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "$@"
}
