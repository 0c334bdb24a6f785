#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures what bench/REPORT.md states, entry by entry. Called by ./nodmap bench, which has built the programs.
#   scripts/bench.sh [--list] [ENTRY ...]     without ENTRY: all of them, which takes hours
# A measurement that misses its target does not keep the others from being made; the exit code is 1 then. Entries without a check of their own only print:
# maps, decision, slam2d, damage, sessions, stability, relocalise, kurt3d, registration, slam6d-scan, slam6d-drives, hours, page, viewer, barn, exploration,
# lost-time, ablation. The documents state their targets.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
bin=build/release/bin
data=${NODMAP_DATA:-../shared/data}
export NODMAP_BENCH_OUT=${NODMAP_BENCH_OUT-logs/bench-$(date +%Y%m%d-%H%M%S)}
out=$NODMAP_BENCH_OUT

# Each entry with the section of bench/REPORT.md that it measures.
entries() {
  cat <<'TEXT'
maps             Map update
decision         A decision of the navigator
slam2d           Whole logs and a match alone (needs the recordings)
paper            docs/paper.md: the targets of the figures; What nodding costs the 2D map
damage           docs/benchmark-2d.md: damaged recordings (needs the recordings)
sessions         docs/benchmark-2d.md: two sessions (needs the recordings)
stability        docs/benchmark-2d.md: stability (needs the recordings)
relocalise       docs/benchmark-2d.md: relocalisation in other buildings
kurt3d           KURT3D (needs the recordings)
registration     clouds whose poses are known: docs/benchmark-3d.md (needs the recordings)
slam6d-scan      A scan in 6D SLAM
slam6d-drives    docs/benchmark-3d.md: simulated drives, in a saved map
hours            6D SLAM for hours; docs/benchmark-2d.md: days in one building
octomap          OctoMap (needs the recordings)
trials           Trials, Stairs and a warehouse, The simulator
stops            How the robot stops when a part fails: in trials
stops-live       How the robot stops when a part fails: live
live             The robot live
attacks          The robot live under attack
busy-page        The page opened while the demo runs
receive          Receiving over LCM
serial           The page opened while the demo runs: the kernel's threads
deputy           Deputy
page             Images per second
viewer           Beside the whole robot
navigation       docs/benchmark-navigation.md: generated worlds
barn             docs/benchmark-navigation.md: BARN (needs its worlds)
exploration      docs/benchmark-navigation.md: exploration
lost-time        docs/benchmark-navigation.md: where the time goes in clutter
ablation         docs/ablation.md: what each part of the navigation is worth
TEXT
}

alone() { tests/support/private_network.sh "$@"; }
live() { alone $bin/nodmap-bench-live --world "sim/worlds/$1.yaml" --out "$out-$2" "${@:2}"; }

# beside_loops N COMMAND: on a busy machine.
beside_loops() {
  local loops=()
  for _ in $(seq "$1"); do
    while :; do :; done &
    loops+=($!)
  done
  trap "kill ${loops[*]}" EXIT
  "${@:2}"
}

need_data() {
  [[ -e "$data/$1" ]] && return
  echo "skipped: $data/$1 is missing; NODMAP_DATA names the folder of recordings"
  return 1
}

# slam2d_log NAME: the log's time and errors, and the time of a match alone.
slam2d_log() {
  $bin/nodmap-convert carmen "$data/slam2d/$1.clf" "$out/$1.lcmlog"
  echo "$1"
  time $bin/nodmap-slam2d --replay "$out/$1.lcmlog" --out "$out/$1"
  $bin/nodmap-evaluate relations "$out/$1/trajectory.tum" "$data/slam2d/$1.relations"
  $bin/nodmap-bench-slam2d-match "$out/$1"
}

measure() {
  case "$1" in
    maps) build/release/bench/map_server_bench; build/release/bench/pitch_controller_table ;;
    decision) build/release/bench/navigator_bench ;;
    slam2d)
      need_data slam2d || return 0
      mkdir -p "$out"
      for name in intel fr079 mit-csail; do slam2d_log "$name"; done
      ;;
    paper) ./nodmap figures --no-page ;;
    damage)
      need_data slam2d || return 0
      python3 bench/slam2d_damage.py --data "$data/slam2d" --seeds 1000 1001
      python3 bench/slam2d_damage.py --data "$data/slam2d" --alone --seeds 0 1
      ;;
    sessions) need_data slam2d || return 0; python3 bench/slam2d_sessions.py --data "$data/slam2d" ;;
    stability) need_data slam2d || return 0; python3 bench/slam2d_stability.py --data "$data/slam2d" ;;
    relocalise)
      $bin/nodmap-bench-slam2d-relocalise building:{0..3} maze:{0,1} sim/worlds/{office,cellar,loop,warehouse}.yaml
      ;;
    kurt3d)
      need_data kurt3d || return 0
      mkdir -p "$out"
      $bin/nodmap-convert uos "$data/kurt3d" "$out/kurt3d.lcmlog"
      time $bin/nodmap-slam6d --replay "$out/kurt3d.lcmlog" --out "$out/kurt3d"
      ;;
    registration)
      need_data nodding_pairs || return 0
      $bin/nodmap-bench-registration pairs "$data/nodding_pairs"
      $bin/nodmap-bench-registration sequence "$data/nodding_seq"
      ;;
    slam6d-scan)
      mkdir -p "$out"
      $bin/nodmap-trial --world sim/worlds/crowd.yaml --seed 1 --duration 35 --no-slam6d --set sim.odometry_scale_bias=0.03 \
        --set sim.slip_heading_deg=1 --out "$out/crowd"
      $bin/nodmap-bench-slam6d "$out/crowd/trial.lcmlog"
      ;;
    slam6d-drives)
      python3 bench/slam6d_drives.py --out "$out/drives" --setting "" "adjustment.use_adjustment=false"
      python3 bench/slam6d_sessions.py "$out"/drives/*
      ;;
    hours)
      python3 bench/slam2d_days.py --hours 1 2 4 8 24
      python3 bench/slam6d_days.py --hours 1 2 4
      ;;
    octomap)
      need_data nodding_seq || return 0
      $bin/nodmap-bench-octomap "$data/nodding_seq" --resolution 0.05 --max-range 10
      ;;
    trials)
      build/release/bench/sim_bench
      python3 bench/trials.py --only random crowd appearing stairs warehouse cellar occupancy clouds speed
      ;;
    stops) python3 bench/trials.py --only stops ;;
    stops-live) live corridor30 faults ;;
    live) live cellar latency --viewer ;;
    attacks) live cellar attacks ;;
    busy-page) python3 bench/page_under_load.py ;;
    receive) alone $bin/nodmap-bench-receive ;;
    serial) beside_loops 6 $bin/nodmap-bench-serial 20 ;;
    deputy) alone build/release/tests/deputy_load_test ;;
    page) python3 bench/viewer_frames.py ;;
    viewer) alone python3 bench/viewer.py --soak 1800 ;;
    navigation) python3 bench/navigation.py ;;
    barn) need_data barn || return 0; python3 bench/barn.py "$data/barn/worlds.txt" --every 10 ;;
    exploration) python3 bench/exploration.py --seeds 10 ;;
    lost-time) python3 bench/lost_time.py --seeds 16 ;;
    ablation) python3 bench/ablation.py ;;
  esac
}

[[ "${1-}" != --list ]] || { entries; exit 0; }
[[ "${1-}" != --measure ]] || { measure "$2"; exit; }
mapfile -t names < <(entries | cut -d' ' -f1)
for name in "$@"; do
  [[ " ${names[*]} " == *" $name "* ]] || { echo "nodmap bench: there is no entry '$name'; --list names them" >&2; exit 2; }
done
[[ $# -eq 0 ]] || names=("$@")
missed=()
for name in "${names[@]}"; do
  printf '==> %s\n' "$(entries | grep "^$name ")"
  # In a shell of its own: an error ends the entry, and nothing else.
  scripts/bench.sh --measure "$name" || missed+=("$name")
done
[[ ${#missed[@]} -eq 0 ]] || { echo "missed: ${missed[*]}"; exit 1; }
