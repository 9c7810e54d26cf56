#!/bin/bash
# air.sh [OUT [ROBOTS…]]: measures the tracking error of teams in config/field.yaml as a function of the network
# budget, with a loss of 20 % of the frames. For comparison, the teams also fly without a budget: over links
# with the same rate and loss, and over an unlimited network. Writes OUT/air.csv and OUT/air.png.
# Defaults: build/air; 3 10 30.
# BIN: the folder of the programs, build/release/bin unless set. SEEDS ("1 2 3"), SECONDS_FLOWN (60),
# BUDGETS ("8 16 33 64", kbit/s per robot).
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-build/air}
shift || true
sizes=("$@")
[[ ${#sizes[@]} -gt 0 ]] || sizes=(3 10 30)
bin=${BIN:-build/release/bin}
flown=${SECONDS_FLOWN:-60}
mkdir -p "$out"
# Prints one line of the table: fly KIND ROBOTS SEED KBITPS OPTION…
fly() {
  local kind=$1 robots=$2 seed=$3 kbitps=$4
  shift 4
  test/rig/air_scenario.py "$robots" --duration-s "$flown" "$@" >"$out/scenario.yaml"
  "$bin/trial_bench" "$out/scenario.yaml" --json --seed "$seed" | python3 -c '
import json, sys
kind, robots, seed, kbitps, flown = sys.argv[1:]
found = json.load(sys.stdin)
own = found["per_robot"]
sent = sum(found.get("air_bytes", {}).values()) / float(robots) / float(flown)
print(kind, robots, seed, kbitps, own["rmse_m"], own["entropy"], own["discovered"], own["nees"]["mean"],
      found["collisions"], round(sent), sep=",")' "$kind" "$robots" "$seed" "$kbitps" "$flown"
}
echo "kind,robots,seed,kbitps,rmse_m,entropy_nat,discovered,nees,collisions,bytes_per_robot_s" >"$out/air.csv"
for seed in ${SEEDS:-1 2 3}; do
  for robots in "${sizes[@]}"; do
    fly unlimited "$robots" "$seed" 0
    for kbitps in ${BUDGETS:-8 16 33 64}; do
      fly budget "$robots" "$seed" "$kbitps" --budget-kbitps "$kbitps" --loss 0.2
      fly links "$robots" "$seed" "$kbitps" --rate-kbitps "$kbitps" --loss 0.2
    done
  done
done | tee -a "$out/air.csv"
gnuplot -e "in='$out'; out='$out'" test/bench/air_plots.gp
