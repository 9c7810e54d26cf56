#!/bin/bash
# log_commands.sh VANTAGE SAMPLE.xz SCENARIO: every command of `vantage log` as docs/logs.md shows
# them, on the sample log and on one of a short trial of SCENARIO, and what they answer.
set -euo pipefail
vantage=$1 sample=$2 scenario=$3
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
xz --decompress --stdout "$sample" > flight.lcmlog
fail() { echo "log_commands: $1" >&2; exit 1; }
json() { python3 -c "import json,sys; d=json.load(sys.stdin); print($1)"; }
events() { "$vantage" log info "$1" --json | json 'd["events"]'; }
exits_with() { local want=$1; shift; set +e; "$@" > out.txt 2> err.txt; local got=$?; set -e
  [[ $got == "$want" ]] || { cat out.txt err.txt; fail "'$*' exits with $got, not $want"; }; }

"$vantage" log info flight.lcmlog
[[ -s flight.lcmlog.index ]] || fail "no index"
all=$(events flight.lcmlog)
exits_with 0 "$vantage" log check flight.lcmlog

# A torn, overwritten copy is found out, mended, and whole again.
size=$(stat -c %s flight.lcmlog)
head -c $((size - 100)) flight.lcmlog > torn.lcmlog
dd if=/dev/urandom of=torn.lcmlog bs=1 seek=$((size / 2)) count=300 conv=notrunc status=none
exits_with 1 "$vantage" log check torn.lcmlog
exits_with 0 "$vantage" log repair torn.lcmlog whole.lcmlog
exits_with 0 "$vantage" log check whole.lcmlog
(($(events whole.lcmlog) >= all - 5)) || fail "repair lost events"
exits_with 2 "$vantage" log repair torn.lcmlog torn.lcmlog
exits_with 2 "$vantage" log repair torn.lcmlog whole.lcmlog
exits_with 2 "$vantage" log info missing.lcmlog

"$vantage" log slice flight.lcmlog part.lcmlog --from-s 20 --to-s 30
"$vantage" log info part.lcmlog --json | json '(d["begins_with_scenario"], 9 < d["duration_s"] <= 10)' \
  | grep -q "(True, True)" || fail "slice"
"$vantage" log filter flight.lcmlog plans.lcmlog --channels 'PLAN_.*' SCENARIO
"$vantage" log info plans.lcmlog --json | json 'sorted(d["channels"])' \
  | grep -q "\['PLAN_Q1', 'PLAN_Q2', 'PLAN_Q3', 'SCENARIO'\]" || fail "filter"
"$vantage" log filter flight.lcmlog rest.lcmlog --without 'PLAN_.*' SCENARIO
"$vantage" log merge plans.lcmlog rest.lcmlog --out both.lcmlog
[[ $(events both.lcmlog) == "$all" ]] || fail "merge"
"$vantage" log rename flight.lcmlog other.lcmlog --rule VICON=MOCAP 'PLAN_*=OLD_PLAN_*'
"$vantage" log info other.lcmlog --json | json 'sorted(c for c in d["channels"] if "MOCAP" in c or "OLD" in c)' \
  | grep -q "\['MOCAP', 'OLD_PLAN_Q1', 'OLD_PLAN_Q2', 'OLD_PLAN_Q3'\]" || fail "rename"

"$vantage" log metrics flight.lcmlog
"$vantage" log metrics flight.lcmlog flight.lcmlog | grep "NEES of a robot" > /dev/null
"$vantage" log metrics flight.lcmlog --json | json 'd["rounds"]' > /dev/null
"$vantage" log fit-motion flight.lcmlog | grep "target_model: {kind: damped_oscillator" > /dev/null
"$vantage" log fit-motion flight.lcmlog --json | json 'len(d["models"])' | grep -q 3 || fail "fit-motion"
"$vantage" trial "$scenario" --duration-s 6 --nodes 200 --log trial.lcmlog > trial.txt
"$vantage" log replay trial.lcmlog --node planner:Q1 --node estimator:Q2
exits_with 2 "$vantage" log replay trial.lcmlog --node planner:Q9
"$vantage" log export flight.lcmlog --to csv --out csv --channels 'PLAN_.*'
[[ $(ls csv) == $'PLAN_Q1.csv\nPLAN_Q2.csv\nPLAN_Q3.csv' ]] || fail "csv"
"$vantage" log export flight.lcmlog --to mcap --out flight.mcap
[[ $(head -c 5 flight.mcap | tail -c 4) == MCAP ]] || fail "mcap"
if command -v gnuplot > /dev/null; then
  "$vantage" log plot flight.lcmlog --out flight.png
  [[ -s flight.png ]] || fail "plot"
fi
echo quit | "$vantage" log play flight.lcmlog --url memq:// --paused --json | json 'd["published"]' \
  | grep -qx 0 || fail "play"
"$vantage" log play flight.lcmlog --url memq:// --speed 64 --to-s 20 --json < /dev/null \
  | json 'd["published"] > 100' | grep -q True || fail "play"
echo "log_commands: all good"
