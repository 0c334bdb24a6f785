#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command in a network of its own, with multicast on its loopback: tests that talk over LCM
# disturb nobody and are disturbed by nobody. Exit code 77 where the system does not permit that.
if ! unshare --map-root-user --net true 2>/dev/null; then
  echo "SKIPPED: no network of its own: unshare --map-root-user --net is not permitted here"
  exit 77
fi
exec unshare --map-root-user --net sh -c \
  'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' isolated "$@"
