#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Two hosts as two network namespaces joined by a cable (veth): what plays the robot's sensors and the maps on A, 6D SLAM and
# logger on B, the sheriff on A. The cable is pulled for 10 s. A must go on as before, B must hear again, and nothing may be
# started anew.
#   two_hosts_test.sh BIN_DIR        exits 77 (skipped) where the machine does not allow it, or data are missing
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
bin=$(readlink -f "$1")
data=${NODMAP_DATA:-../shared/data}/kurt3d
[[ -d "$data" ]] || { echo "missing data: kurt3d (set NODMAP_DATA)"; exit 77; }
if [[ "${NODMAP_HOST_A:-}" != 1 ]]; then
  unshare -rn unshare -n true 2>/dev/null || { echo "skipped: this machine gives users no networks of their own"; exit 77; }
  exec env NODMAP_HOST_A=1 NODMAP_DATA="$(readlink -f "$data/..")" unshare -rn "$0" "$bin"
fi

work=$(mktemp -d)
pids=()
end() {
  trap - EXIT
  local pid
  for pid in "${pids[@]}"; do kill -TERM "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap end EXIT
fail() { echo "FAILED: $*"; tail -n 20 "$work"/*.log; exit 1; }

# A host, or the switch between the two, is the network of a process that does nothing else; `on PID command` runs one there.
new_network() {
  unshare -n sleep 1000 &
  network=$!
  pids+=("$network")
  for _ in $(seq 100); do
    [[ "$(readlink "/proc/$network/ns/net")" != "$(readlink /proc/self/ns/net)" ]] && return
    sleep 0.02
  done
}
on() { local pid=$1; shift; nsenter -t "$pid" -n -- "$@"; }
ip link set lo up
new_network; host_b=$network
new_network; switch=$network
ip link add cable type veth peer name to_a netns "$switch" || { echo "skipped: no veth here"; exit 77; }
on "$host_b" ip link add cable type veth peer name to_b netns "$switch"
on "$switch" ip link add bridge type bridge mcast_snooping 0 || { echo "skipped: no bridge here"; exit 77; }
for port in to_a to_b; do
  on "$switch" ip link set "$port" master bridge
  on "$switch" ip link set "$port" up
done
on "$switch" ip link set bridge up
ip addr add 10.0.0.1/24 dev cable
on "$host_b" ip addr add 10.0.0.2/24 dev cable
for host in $$ "$host_b"; do
  on "$host" ip link set lo up
  on "$host" ip link set cable up
  on "$host" ip route add 224.0.0.0/4 dev cable
done
# Pulled at the switch: each host loses the carrier, and keeps address and route, as with a real cable.
cable() { on "$switch" ip link set to_a "$1"; on "$switch" ip link set to_b "$1"; }
export LCM_DEFAULT_URL='udpm://239.255.76.67:7694?ttl=1&recv_buf_size=2000000'

"$bin/nodmap-convert" uos "$data" "$work/drive.lcmlog" >/dev/null
cat >"$work/two.pmd" <<PMD
group "a" {
  cmd "map-server" { exec = "nodmap-map-server"; host = "robot"; auto_respawn = "true"; }
  cmd "drive" { exec = "bash -c 'while true; do lcm-logplayer --speed=1 $work/drive.lcmlog; done'"; host = "robot"; }
}
group "b" {
  cmd "slam6d" { exec = "nodmap-slam6d"; host = "mapper"; auto_respawn = "true";
    #nodmap: restart_silent_s = 5;
  }
  cmd "logger" { exec = "nodmap-logger --out $work/logs"; host = "mapper"; auto_respawn = "true";
    #nodmap: restart_silent_s = 5;
  }
}
script "go" { start group "b" wait "running"; start group "a" wait "running"; }
PMD
"$bin/nodmap-deputy" --config "$work/two.pmd" --id robot >"$work/robot.log" 2>&1 & pids+=($!)
on "$host_b" "$bin/nodmap-deputy" --config "$work/two.pmd" --id mapper >"$work/mapper.log" 2>&1 & pids+=($!)
"$bin/nodmap-sheriff" "$work/two.pmd" --script go --on-script-complete stay >"$work/sheriff.log" 2>&1 & pids+=($!)

# state COMMAND KEY: by a second look from host A
state() {
  "$bin/nodmap-sheriff" "$work/two.pmd" --status --json 2>/dev/null |
    python3 -c "import json, sys; print(*[str(c['$2']) for c in json.load(sys.stdin)['commands'] if c['command'] == '$1'])" || true
}
wait_for() { # TEXT FILE
  for _ in $(seq 300); do grep -q "$1" "$2" && return; sleep 0.1; done
  fail "'$1' never came in $2"
}
pids_of_commands() { local c; for c in map-server drive slam6d logger; do echo "$c $(state $c pid)"; done; }
scans_logged() { cat "$work"/logs/* 2>/dev/null | grep -a -o SCAN | wc -l; }

wait_for "script go is done" "$work/sheriff.log"
sleep 3
before=$(pids_of_commands)
echo "$before"
[[ "$before" != *" 0"* ]] || fail "not everything runs"
[[ $(scans_logged) -gt 0 ]] || fail "B hears no SCAN"

echo "pulling the cable for 10 s"
maps_before=$(state map-server health)
cable down
sleep 7
[[ "$(state slam6d state)" == Unknown ]] || fail "B is gone, and the sheriff does not say so"
[[ "$(state map-server state)" == Running ]] || fail "A does not go on"
sleep 1
scans_apart=$(scans_logged)
cable up
sleep 6
after=$(pids_of_commands)
[[ "$before" == "$after" ]] || fail "something was started anew: $after"
[[ "$(state slam6d state)" == Running ]] || fail "B is not back"
[[ $(scans_logged) -gt $scans_apart ]] || fail "B hears no SCAN again"
grep -q "^restarting" "$work/sheriff.log" && fail "a restart: $(grep '^restarting' "$work/sheriff.log")"
echo "map-server before: $maps_before"
echo "map-server after:  $(state map-server health)"
echo "A went on, B came back, nothing was started anew"
