# SPDX-License-Identifier: BSD-3-Clause
# Sourced, with $bin. A machine without a multicast route (a container, say) cannot carry LCM; a network namespace of our own can.
#   need_multicast SCRIPT [ARGUMENT ...]   returns where there is a route and a bus that nobody uses; without a route runs the script anew in such
#                                          a namespace
export LCM_DEFAULT_URL=${LCM_DEFAULT_URL:-udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304}
# On the bus of a robot a demo would command that robot: release it and let it drive. A robot obeys us whether or not we trust its host.
need_silence() {
  local findings
  findings=$(NODMAP_TRUSTED_HOSTS=0.0.0.0/0 "$bin/nodmap-doctor" --silence) ||
    die "starts only on a bus that works and that no other robot or demo uses ($LCM_DEFAULT_URL):"$'\n'"$findings"
}
need_multicast() {
  [[ "${NODMAP_PRIVATE_NET:-}" != 1 ]] || return 0
  if ip route get 239.255.76.67 >/dev/null 2>&1; then
    need_silence
    return
  fi
  # Root needs no user namespace (-r), which would take away the right to real-time priority.
  local new_network=(unshare -n)
  "${new_network[@]}" true 2>/dev/null || new_network=(unshare -rn)
  "${new_network[@]}" true 2>/dev/null || die "there is no multicast route for LCM; nodmap-doctor says how to add one"
  say "no multicast route here: running in a network namespace of our own"
  exec env NODMAP_PRIVATE_NET=1 python3 scripts/page_door.py open "${new_network[@]}" sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "$@"
}
