#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command on a network of its own, with multicast on its loopback: LCM's real transport, and
# nobody else hears it. Exits 77 (CTest: skipped) where the machine does not allow that.
if ! unshare -rn true 2>/dev/null; then
  echo "skipped: this machine gives users no network of their own (unshare -rn)"
  exit 77
fi
# Over the network whatever the caller's environment says: memq://, say, would make each process deaf.
unset LCM_DEFAULT_URL
# shellcheck disable=SC2016  # expanded inside
exec unshare -rn sh -c '
  ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || exit 77
  exec "$@"' sh "$@"
