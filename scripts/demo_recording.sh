#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The system on a recording: every process by itself, the recording played over LCM. Called by ./nodmap demo.
#   scripts/demo_recording.sh [--check-arguments] RECORDING [--speed FACTOR] [--out DIR]
set -euo pipefail
# First of all: without a trap bash goes on after a Ctrl-C if the command that it waits for has just ended by itself.
trap 'exit 130' INT
export NODMAP_CALLER=${NODMAP_CALLER:-$PWD}
cd -P "${0%/*}/.."
bin=$PWD/build/release/bin
source scripts/demo_common.sh

usage() {
  cat <<'TEXT'
usage: ./nodmap demo RECORDING [--speed FACTOR] [--out DIR]

Plays a recording over LCM to the real processes, which map it.

  RECORDING       a folder of 3DTK scans (scan000.3d, ...), a CARMEN log (.clf), a line-by-line nodding recording (.nod) or an
                  LCM event log
  --speed FACTOR  how many times as fast as it was recorded (1)
  --out DIR       a new folder for the results (logs/demo-DATE-TIME)
  --version       print the version
TEXT
}

# What a recording is, is told by its ending; an event log by what is in it.
need_recording() {
  [[ -e "$1" ]] || usage_error "$1: cannot open: No such file or directory"
  [[ -d "$1" || "$1" == *.clf || "$1" == *.nod ]] && return
  LC_ALL=C grep -qaP '\xED\xA1\xDA\x01' "$1" ||
    usage_error "$1: is neither a folder of 3DTK scans, a CARMEN log (.clf), a nodding recording (.nod) nor an LCM event log"
}

check_only=0 recording='' speed=1
printf -v out '%s/logs/demo-%(%Y%m%d-%H%M%S)T' "$PWD" -1
while [[ $# -gt 0 ]]; do
  case "$1" in
    --check-arguments) check_only=1; shift ;;
    --help | -h) usage; exit 0 ;;
    --version) print_version; exit 0 ;;
    --speed) need_value "$@"; need_number "$1" "$2"; speed=$2; shift 2 ;;
    --out) need_value "$@"; from_caller out "$2"; shift 2 ;;
    -*) usage_error "unknown option $1" ;;
    *) [[ -z "$recording" ]] || usage_error "unexpected argument $1"; from_caller recording "$1"; shift ;;
  esac
done
[[ -n "$recording" ]] || usage_error "no recording is named"
need_recording "$recording"
need_new "$out"
[[ $check_only -eq 0 ]] || exit 0

source scripts/private_net.sh
source scripts/demo_page.sh
need_multicast "$0" "$recording" --speed "$speed" --out "$out"

mkdir -p "$out"
trap 'rmdir "$out" 2>/dev/null || true' EXIT  # a recording that cannot be converted leaves nothing
name_page
log=$out/recording.lcmlog
map_config=()
say "converting $recording"
case "$recording" in
  *.clf) "$bin/nodmap-convert" carmen "$recording" "$log" ;;
  *.nod) "$bin/nodmap-convert" nod "$recording" "$log" ;;
  *)
    if [[ -d "$recording" ]]; then
      "$bin/nodmap-convert" uos "$recording" "$log"
      map_config=(--config config/uos/map_server.yaml)
    else
      cp "$recording" "$log"
    fi
    ;;
esac
"$bin/nodmap-convert" info "$log"

names=() pids=() player=
stop_all() {
  trap - EXIT INT TERM HUP
  [[ -z "$player" ]] || kill "$player" 2>/dev/null || true
  local i
  for i in "${!pids[@]}"; do kill -INT "${pids[$i]}" 2>/dev/null || true; done
  # A process that has not ended by itself after 30 s is a fault; it is killed and said to have failed. A busy machine saves a map more slowly.
  local deadline=$((SECONDS + 30)) failed=0 code
  for i in "${!pids[@]}"; do
    while kill -0 "${pids[$i]}" 2>/dev/null && [[ $SECONDS -lt $deadline ]]; do sleep 0.05; done
    kill -KILL "${pids[$i]}" 2>/dev/null && { echo "${names[$i]} did not end by itself and was killed"; failed=1; }
    code=0; wait "${pids[$i]}" 2>/dev/null || code=$?
    [[ $code -eq 0 ]] || { echo "${names[$i]} ended with code $code; see $out/${names[$i]}.log"; failed=1; }
  done
  return $failed
}
trap 'stop_all || true; exit 130' INT TERM HUP
trap 'stop_all || true' EXIT

start() {
  local name=$1
  shift
  "$@" >"$out/$name.log" 2>&1 &
  pids+=($!) names+=("$name")
}

say "starting the processes (LCM: $LCM_DEFAULT_URL)"
start map-server "$bin/nodmap-map-server" "${map_config[@]}" --out "$out/map-server"
start slam2d "$bin/nodmap-slam2d" --out "$out/slam2d"
start slam6d "$bin/nodmap-slam6d" --out "$out/slam6d"
start logger "$bin/nodmap-logger" --out "$out/logger"
start viewer "$bin/nodmap-viewer" --port "$NODMAP_PORT"
for i in "${!pids[@]}"; do
  for _ in $(seq 200); do
    grep -q "listening on" "$out/${names[$i]}.log" && break
    kill -0 "${pids[$i]}" 2>/dev/null || { cat "$out/${names[$i]}.log"; die "${names[$i]} did not start"; }
    sleep 0.05
  done
  grep -q "listening on" "$out/${names[$i]}.log" || die "${names[$i]} does not listen after 10 s; see $out/${names[$i]}.log"
  echo "  ${names[$i]} (pid ${pids[$i]})"
done

open_page
say "playing the recording at $speed x over LCM"
# Only what the sensors measured: a robot's log holds commands too, and what its own processes computed.
lcm-logplayer -s "$speed" -e '^(SCAN|ODOMETRY|PITCH_STATE|BASE_SENSORS)$' "$log" >"$out/logplayer.log" 2>&1 &
player=$!
duration=$("$bin/nodmap-convert" info "$log" | awk '/^duration/ {print int($2) + 1; exit}')
began=$SECONDS
while kill -0 "$player" 2>/dev/null; do
  [[ -t 1 ]] && printf '\r  %3d of about %d s' $((SECONDS - began)) "$(awk "BEGIN {print int($duration / $speed) + 1}")"
  sleep 0.2
done
[[ -t 1 ]] && printf '\r%30s\r' ''
wait "$player" || die "lcm-logplayer failed: $(cat "$out/logplayer.log")"
player=

say "stopping the processes"
stop_all || die "not every process ended cleanly"
python3 scripts/demo_summary.py recording "$out"
