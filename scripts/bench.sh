#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures what bench/REPORT.md states, entry by entry. Called by ./nodmap bench, which has built the programs.
#   scripts/bench.sh [--check-arguments] [--list | ENTRY ...]     without ENTRY: all of them, which takes hours
# A measurement that misses its target does not keep the others from being made; the exit code is 1 then.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
bin=build/release/bin
data=${NODMAP_DATA:-../shared/data}
export NODMAP_BENCH_OUT=${NODMAP_BENCH_OUT-logs/bench-$(date +%Y%m%d-%H%M%S)}
out=$NODMAP_BENCH_OUT

# Each entry, whether it checks its targets or only prints (the documents then state the targets), and the section of bench/REPORT.md that it
# measures.
entries() {
  cat <<'TEXT'
maps           prints  Map update
decision       prints  A decision of the navigator
slam2d         prints  Whole logs and a match alone (needs the recordings)
paper          checks  docs/paper.md: the targets of the figures; What nodding costs the 2D map
damage         prints  docs/benchmark-2d.md: damaged recordings (needs the recordings)
sessions       prints  docs/benchmark-2d.md: two sessions (needs the recordings)
stability      prints  docs/benchmark-2d.md: stability (needs the recordings)
relocalise     prints  docs/benchmark-2d.md: relocalisation in other buildings
pose-graph     prints  docs/decisions/007-own-pose-graph.md (needs the recordings, and libceres-dev)
kurt3d         prints  KURT3D (needs the recordings)
registration   prints  clouds whose poses are known: docs/benchmark-3d.md (needs the recordings)
slam6d-scan    prints  A scan in 6D SLAM
slam6d-drives  prints  docs/benchmark-3d.md: simulated drives, in a saved map
slam6d-ablation  prints  docs/benchmark-3d.md: what each part is worth
slam6d-jumps   checks  docs/benchmark-3d.md: 200 drives without a jump
laps           prints  docs/benchmark-3d.md: two kilometres in one building
structure-map  prints  docs/benchmark-2d.md: the structure map as a virtual scan
slow-odometry  prints  docs/benchmark-3d.md: slow odometry
sensitivity    prints  docs/benchmark-3d.md: the simulator's ideal parts
hours          prints  6D SLAM for hours; docs/benchmark-2d.md: days in one building
octomap        checks  OctoMap (needs the recordings)
trials         checks  Trials, Stairs and a warehouse, The simulator
stops          checks  How the robot stops when a part fails: in trials
stops-live     checks  How the robot stops when a part fails: live
live           checks  The robot live
attacks        checks  The robot live under attack
busy-page      checks  The page opened while the demo runs
receive        checks  Receiving over LCM
serial         checks  The page opened while the demo runs: the kernel's threads
deputy         checks  Deputy
page           prints  Images per second
viewer         prints  Beside the whole robot
navigation     checks  docs/benchmark-navigation.md: generated worlds
barn           prints  docs/benchmark-navigation.md: BARN (needs its worlds)
exploration    prints  docs/benchmark-navigation.md: exploration
lost-time      prints  docs/benchmark-navigation.md: where the time goes in clutter
ablation       prints  docs/ablation.md: what each part of the navigation is worth
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

# in_bench MODULE.NAME: the words of a list in bench/MODULE.py.
in_bench() { PYTHONPATH=bench python3 -c "import ${1%%.*}; print(*$1)"; }

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
      for name in $(in_bench "programs.LOGS"); do slam2d_log "$name"; done
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
    pose-graph)
      need_data slam2d || return 0
      [[ -x $bin/nodmap-bench-pose-graph ]] || { echo "skipped: built without Ceres; install libceres-dev, and build again"; return 0; }
      for name in intel fr079 mit-csail; do
        $bin/nodmap-convert carmen "$data/slam2d/$name.clf" "$out/$name.lcmlog"
        $bin/nodmap-slam2d --replay "$out/$name.lcmlog" --out "$out/$name"
        $bin/nodmap-bench-pose-graph "$out/$name"
      done
      ;;
    kurt3d)
      need_data kurt3d || return 0
      mkdir -p "$out"
      $bin/nodmap-convert uos "$data/kurt3d" "$out/kurt3d.lcmlog"
      time $bin/nodmap-slam6d --replay "$out/kurt3d.lcmlog" --out "$out/kurt3d"
      $bin/nodmap-bench-kurt3d-planes "$data/kurt3d" "$out/kurt3d/trajectory.tum"
      ;;
    registration)
      need_data nodding_pairs || return 0
      $bin/nodmap-bench-registration pairs "$data/nodding_pairs"
      $bin/nodmap-bench-registration sequence "$data/nodding_seq"
      ;;
    slam6d-scan)
      mkdir -p "$out"
      # shellcheck disable=SC2046
      $bin/nodmap-trial --world sim/worlds/crowd.yaml --seed 1 --duration 35 --no-slam6d $(in_bench "seeds.ODOMETRY_NOISE") --out "$out/crowd"
      $bin/nodmap-bench-slam6d "$out/crowd/trial.lcmlog"
      ;;
    slam6d-drives)
      python3 bench/slam6d_drives.py --out "$out/drives" --setting "" "adjustment.use_adjustment=false"
      python3 bench/slam6d_sessions.py "$out"/drives/*
      ;;
    slam6d-ablation) python3 bench/slam6d_ablation.py ;;
    slam6d-jumps) python3 bench/slam6d_jumps.py ;;
    laps) python3 bench/slam_laps.py ;;
    structure-map) python3 bench/slam2d_structure_map.py ;;
    slow-odometry) python3 bench/slow_odometry.py --out "$out/drives" ;;
    sensitivity) python3 bench/sensitivity.py ;;
    hours)
      python3 bench/slam2d_days.py --hours 1 2 4 8 24
      python3 bench/slam6d_days.py --hours 1 2 4
      ;;
    octomap)
      need_data nodding_seq || return 0
      $bin/nodmap-bench-octomap "$data/nodding_seq" --resolution 0.05 --max-range 10
      $bin/nodmap-bench-octomap "$data/nodding_seq" --resolution 0.05 --max-range 10 --discretize
      ;;
    trials)
      build/release/bench/sim_bench
      python3 bench/trials.py --only random crowd appearing stairs warehouse storeys cellar occupancy clouds speed
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
    barn)
      need_data barn || return 0
      python3 bench/barn.py "$data/barn/worlds.txt" --runs 10
      python3 bench/barn.py "$data/barn/worlds.txt" --runs 10 --robot jackal
      ;;
    exploration) python3 bench/exploration.py --seeds 10 ;;
    lost-time) python3 bench/lost_time.py --seeds 16 ;;
    ablation) python3 bench/ablation.py ;;
  esac
}

check_only=0
[[ "${1-}" != --check-arguments ]] || { check_only=1; shift; }
case " $* " in *" --help "* | *" -h "*) echo 'usage: ./nodmap bench [--list | ENTRY ...]     without ENTRY: all of them, which takes hours'; exit 0 ;; esac
[[ "${1-}" != --list ]] || { entries; exit 0; }
[[ "${1-}" != --measure ]] || { measure "$2"; exit; }
mapfile -t names < <(entries | cut -d' ' -f1)
for name in "$@"; do
  [[ " ${names[*]} " == *" $name "* ]] || { echo "nodmap bench: there is no entry '$name'; ./nodmap bench --list names them" >&2; exit 2; }
done
[[ $check_only -eq 0 ]] || exit 0
[[ $# -eq 0 ]] || names=("$@")
missed=()
for name in "${names[@]}"; do
  printf '==> %s\n' "$(entries | grep "^$name ")"
  # In a shell of its own: an error ends the entry, and nothing else.
  scripts/bench.sh --measure "$name" || missed+=("$name")
done
[[ ${#missed[@]} -eq 0 ]] || { echo "missed: ${missed[*]}"; exit 1; }
