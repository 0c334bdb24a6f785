#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command in a network namespace of its own, with multicast on the loopback: LCM's real transport,
# which no other process receives. Exits with 77 (CTest: skipped) if the machine does not allow this. Root needs
# no user namespace (-r), which would take away the right to real-time priority.
new_network="unshare -n"
$new_network true 2>/dev/null || new_network="unshare -rn"
if ! $new_network true 2>/dev/null; then
  echo "skipped: this machine gives users no network namespace of their own (unshare -rn)"
  exit 77
fi
# Uses the network whatever the caller's environment says: with memq://, for example, processes would not reach
# each other.
unset LCM_DEFAULT_URL
# shellcheck disable=SC2016  # expanded inside
exec $new_network sh -c '
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 77
  exec "$@"' sh "$@"
