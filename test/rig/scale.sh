#!/bin/bash
# scale.sh [OUT [ROBOTS…]]: measures the computing cost of trials by team size, with one target and 400 m²
# (20 m × 20 m) per robot. Writes OUT/cost.csv, OUT/traffic.csv (bytes per second that a robot publishes,
# by channel) and OUT/scale.png. Defaults: build/scale; 3 10 30 100 300 1000.
# Needs an otherwise idle machine for about 10 min, and 4 GB. BIN: the folder of the programs,
# build/release/bin unless set. NODES: search nodes per plan (5000). SECONDS_FLOWN: s per trial (5).
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-build/scale}
shift || true
sizes=("$@")
[[ ${#sizes[@]} -gt 0 ]] || sizes=(3 10 30 100 300 1000)
bin=${BIN:-build/release/bin}
mkdir -p "$out"
: >"$out/traffic.csv"
head=(--csv-head)
for robots in "${sizes[@]}"; do
  scenario=$out/crowd$robots.yaml
  test/rig/crowded_scenario.py "$robots" "$robots" --planner arvi --nodes "${NODES:-5000}" \
    --area-m2 400 --communication-range-m 25 --neighbourhood-m 36 --cell-m 2 --slots 48 \
    --duration-s "${SECONDS_FLOWN:-5}" >"$scenario"
  "$bin/trial_bench" "$scenario" --csv "${head[@]}"
  head=()
  rm -f "$out/crowd.lcmlog"
  "$bin/trial_bench" "$scenario" --duration-s 3 --nodes 200 --log "$out/crowd.lcmlog" >>"$out/traffic.csv"
done | tee "$out/cost.csv"
rm -f "$out/crowd.lcmlog" "$out/crowd.lcmlog.index"
gnuplot -e "in='$out'; out='$out'" test/bench/scale_plots.gp
