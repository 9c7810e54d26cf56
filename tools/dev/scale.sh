#!/bin/bash
# scale.sh [OUT [ROBOTS…]]: what trials of growing teams cost, as many targets as robots, 400 m² of field
# for each (20 m × 20 m), everything else the same: OUT/cost.csv, OUT/traffic.csv (bytes that a robot
# says in a second, by channel) and OUT/scale.png (build/scale; 3 10 30 100 300 1000).
# A machine that is doing nothing else for about ten minutes, and 4 GB. BIN: the folder of the programs,
# build/release/bin unless set. NODES, SECONDS_FLOWN: of work a plan (5000), of each trial (5).
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
  tools/dev/crowded_scenario.py "$robots" "$robots" --planner arvi --nodes "${NODES:-5000}" \
    --area-m2 400 --communication-range-m 25 --neighbourhood-m 36 --cell-m 2 --slots 48 \
    --duration-s "${SECONDS_FLOWN:-5}" >"$scenario"
  "$bin/trial_bench" "$scenario" --csv "${head[@]}"
  head=()
  rm -f "$out/crowd.lcmlog"
  "$bin/trial_bench" "$scenario" --duration-s 3 --nodes 200 --log "$out/crowd.lcmlog" >>"$out/traffic.csv"
done | tee "$out/cost.csv"
rm -f "$out/crowd.lcmlog" "$out/crowd.lcmlog.index"
gnuplot -e "in='$out'; out='$out'" test/bench/scale_plots.gp
