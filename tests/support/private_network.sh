#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command on a network of its own, with multicast on its loopback: LCM's real transport, and
# nobody else hears it. Exits 77 (CTest: skipped) where the machine does not allow that.
# Root needs no user namespace (-r), which would take away the right to real-time priority.
new_network="unshare -n"
$new_network true 2>/dev/null || new_network="unshare -rn"
if ! $new_network true 2>/dev/null; then
  echo "skipped: this machine gives users no network of their own (unshare -rn)"
  exit 77
fi
# Over the network whatever the caller's environment says: memq://, say, would make each process deaf.
unset LCM_DEFAULT_URL
# shellcheck disable=SC2016  # expanded inside
exec $new_network sh -c '
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 77
  exec "$@"' sh "$@"
