#!/bin/bash
# log_commands.sh VANTAGE SAMPLE.xz SCENARIO: runs every command of `vantage log` as shown in
# docs/guide/logs.md, on the sample log and on the log of a short trial of SCENARIO, with the
# expected output.
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

# A truncated and overwritten copy is found damaged; its repaired version is not.
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
# Several planners and seeds are compared; their logs are averaged by planner.
"$vantage" trial "$scenario" --planner greedy,random_walk --seeds 1-2 --duration-s 4 --nodes 300 --jobs 2 \
  --log trials --svg compared.svg > compared.txt
grep -q "^difference to greedy" compared.txt || fail "trial --planner: no differences"
grep -q "random_walk" compared.svg || fail "trial --planner: no figure"
[[ $(ls trials) == $'greedy_1.lcmlog\ngreedy_2.lcmlog\nrandom_walk_1.lcmlog\nrandom_walk_2.lcmlog' ]] ||
  fail "trial --log"
exits_with 2 "$vantage" trial "$scenario" --planner greedy --seeds 1-2 --duration-s 4 --nodes 300 --log trials
exits_with 2 "$vantage" trial "$scenario" --seeds 2-1
"$vantage" log metrics trials/*.lcmlog > grouped.txt
grep -q "differ in planner.algorithm" grouped.txt || fail "metrics does not name the difference"
[[ $(grep "^RMSE of a robot" grouped.txt) == $(grep "^RMSE of a robot" compared.txt) ]] ||
  fail "metrics and trial differ"
"$vantage" log metrics trials/*.lcmlog --svg grouped.svg > /dev/null
grep -q "planner.algorithm" grouped.svg || fail "metrics --svg does not name the difference"
"$vantage" log metrics --pool trials/*.lcmlog | grep "^trials  *4$" > /dev/null || fail "metrics --pool"
"$vantage" log metrics flight.lcmlog --json | json 'd["rounds"]' > /dev/null
"$vantage" log fit-motion flight.lcmlog | grep "target_model: {kind: damped_oscillator" > /dev/null
"$vantage" log fit-motion flight.lcmlog --json | json 'len(d["models"])' | grep -q 3 || fail "fit-motion"
python3 - << 'END'
import math
import random
random.seed(1)
way = [(0.5 * k, 20 * math.cos(0.05 * k), 15 * math.sin(0.05 * k)) for k in range(500)]
beacons = {"1": (9, 30), "2": (-25, 4)}
def table(name, header, rows):
    with open(name, "w") as file:
        file.write(header + "\r\n" + "".join(",".join(map(str, row)) + "\r\n" for row in rows))
table("way.csv", "time_s,x_m,y_m", way)
ranges = [(1000 * t, b, 107 * math.dist((x, y), at) + random.gauss(20, 30))
          for t, x, y in way for b, at in beacons.items()]
random.shuffle(ranges)
table("ranges.csv", "time [ms],beacon_id,range_cm", ranges + [(3, "1", "nan")])
table("survey.csv", "beacon_id,x_m,y_m", [(b, *at) for b, at in beacons.items()])
END
"$vantage" log fit-ranges ranges.csv --poses way.csv --beacons survey.csv | grep "mean NEES of the beacons" > /dev/null
"$vantage" log fit-ranges ranges.csv --poses way.csv --beacons survey.csv --json > fit.json
json 'abs(d["range_scale"] - 1.07) < 4 * d["range_scale_sigma"] < 0.05' < fit.json | grep -q True || fail "fit-ranges: scale"
json 'max(b["error_m"] for b in d["beacons"]) < 0.5' < fit.json | grep -q True || fail "fit-ranges: beacons"
json '(d["ranges"]["not_finite"], d["ranges"]["used"])' < fit.json | grep -q "(1, 1000)" || fail "fit-ranges: counts"
# In this log, the robots' sensors measure distances 10 % too long, and targets are stationary.
sed -e 's/range_scale: 1 *$/range_scale: 1.1/' -e 's/motion: random_waypoint/motion: still/' "$scenario" > long.yaml
"$vantage" trial long.yaml --duration-s 240 --nodes 200 --log still.lcmlog > still.txt
"$vantage" log fit-ranges still.lcmlog --json > still.json
json 'abs(d["range_scale"] - 1.1) < 3 * d["range_scale_sigma"] < 0.25 and len(d["beacons"]) > 2' < still.json | grep -q True || fail "fit-ranges of a log"
# A data set of three simulated robots: import, fit of sensors and drives, localisers.
"$(dirname "$0")/mrclam_folder.py" set
"$vantage" log import mrclam set set.lcmlog > import.txt
grep -q "of 3 robots and 12 landmarks" import.txt || fail "import"
exits_with 0 "$vantage" log check set.lcmlog
exits_with 2 "$vantage" log import mrclam set set.lcmlog
grep -q "exists already" err.txt || fail "import overwrites a log"
cp -r set torn-set
truncate -s -15 torn-set/Robot2_Measurement.dat
exits_with 2 "$vantage" log import mrclam torn-set set.lcmlog --force
grep -q "Robot2_Measurement.dat:[0-9]*: '.*' must consist of 4 finite numbers" err.txt || fail "import of a torn file"
exits_with 0 "$vantage" log check set.lcmlog
[[ -z $(find . -name '*.part') ]] || fail "import leaves a part of a log"
"$vantage" log fit-sensor set.lcmlog --out fitted.yaml --json > fit.json
json 'max(abs(r["range_scale"] - 1.03) for r in d["robots"]) < 0.003' < fit.json | grep -q True || fail "fit-sensor: scale"
json 'all(r["range_is_depth"] for r in d["robots"])' < fit.json | grep -q True || fail "fit-sensor: depth"
json 'max(abs(r["forward_m"] - 0.08) for r in d["robots"]) < 0.016' < fit.json | grep -q True || fail "fit-sensor: place"
json 'max(abs(r["stamp_delay_s"] - 0.04) for r in d["robots"]) < 0.008' < fit.json | grep -q True || fail "fit-sensor: stamp"
json 'max(abs(r["drive"]["delay_s"] + r["drive"]["lag_s"] - 0.15) for r in d["robots"]) < 0.03' < fit.json \
  | grep -q True || fail "fit-sensor: command delay"
exits_with 0 "$vantage" check fitted.yaml
"$vantage" log fit-sensor set.lcmlog > section.txt
grep -q "^localizer:" section.txt || fail "fit-sensor prints no section"
"$vantage" log fit-sensor set.lcmlog --without-truth --json > blind.json
json 'all(r["range_is_depth"] and abs(r["range_scale"] - 1.03) < 0.02 for r in d["robots"])' < blind.json \
  | grep -q True || fail "fit-sensor --without-truth"
rmse() { "$vantage" log localize "$@" --json | json 'd["position_m"]["rmse"]'; }
below() { python3 -c "import sys; sys.exit(not float(sys.argv[1]) < float(sys.argv[2]))" "$1" "$2" || fail "$3: $1"; }
[[ $(rmse set --scenario fitted.yaml) == "$(rmse set.lcmlog --scenario fitted.yaml)" ]] || fail "localize a folder"
filtered=$(rmse set.lcmlog --scenario fitted.yaml)
below "$filtered" 0.03 "localize"
below "$filtered" "$(rmse set.lcmlog)" "fitted parameters do not improve localize"
below "$(rmse set.lcmlog --scenario fitted.yaml --loss 0.2)" 0.03 "localize with loss"
below "$(rmse set.lcmlog --scenario fitted.yaml --start unknown)" 0.03 "localize with unknown start"
below "$(rmse set.lcmlog --scenario fitted.yaml --late-s 20)" "$filtered" "localize late"
below "$(rmse set.lcmlog --scenario fitted.yaml --smoothed)" "$filtered" "localize smoothed"
below "$(rmse set.lcmlog --scenario fitted.yaml --landmarks unknown)" 0.06 "localize with unknown landmarks"
"$vantage" log localize set.lcmlog --scenario fitted.yaml --landmarks unknown --smoothed --json > hidden.json
json 'd["landmarks"]["found"] == 12 and d["landmarks"]["own_rmse_m"] < 0.03' < hidden.json | grep -q True || fail "landmarks"
"$vantage" log localize set.lcmlog --scenario fitted.yaml --without-ids > without.txt
grep -q "lost robots: none" without.txt || fail "localize --without-ids"
exits_with 2 "$vantage" log localize set.lcmlog --landmarks unknown --start unknown
exits_with 2 "$vantage" log localize set.lcmlog --without-ids --start unknown
"$vantage" log localize set.lcmlog --scenario fitted.yaml --out poses.lcmlog --csv poses.csv > poses.txt
grep -q "^all robots" poses.txt || fail "localize"
[[ $(events poses.lcmlog) == $(wc -l < poses.csv) ]] || fail "localize: log and table differ"
exits_with 0 "$vantage" log check poses.lcmlog
exits_with 2 "$vantage" log localize set.lcmlog --heading R9
exits_with 2 "$vantage" log localize set.lcmlog --smoothed --loss 0.1
exits_with 2 "$vantage" log localize flight.lcmlog
grep -q "no section localizer" err.txt || fail "localize of a log without the section"
"$vantage" trial "$scenario" --duration-s 6 --nodes 200 --log trial.lcmlog > trial.txt
"$vantage" log replay trial.lcmlog --node planner:Q1 --node estimator:Q2
exits_with 2 "$vantage" log replay trial.lcmlog --node planner:Q9
"$vantage" log export flight.lcmlog --to csv --out results > /dev/null
[[ $(ls results) == $'contacts.csv\nestimates.csv\nplans.csv\nposes.csv\nvehicles.csv' ]] || fail "result tables"
python3 - results/estimates.csv "$("$vantage" log metrics flight.lcmlog --json)" << 'END' || fail "estimates.csv"
import csv, json, sys
rows = list(csv.DictReader(open(sys.argv[1])))
rmse_m = json.loads(sys.argv[2])["per_robot"]["rmse_m"]
errors = [float(row["error_m"]) for row in rows if row["error_m"]]
times = [float(row["t_s"]) for row in rows]
assert len(errors) > 0.9 * len(rows) and 0 <= min(times) and max(times) < 61, (len(rows), len(errors))
mean_square_m = (sum(error**2 for error in errors) / len(errors)) ** 0.5
assert 0.5 * rmse_m < mean_square_m < 2 * rmse_m, (mean_square_m, rmse_m)
END
"$vantage" log export flight.lcmlog --to csv --out csv --channels 'PLAN_.*'
[[ $(ls csv) == $'PLAN_Q1.csv\nPLAN_Q2.csv\nPLAN_Q3.csv' ]] || fail "csv"
"$vantage" log export flight.lcmlog --to mcap --out flight.mcap
[[ $(head -c 5 flight.mcap | tail -c 4) == MCAP ]] || fail "mcap"
if command -v gnuplot > /dev/null; then
  "$vantage" log plot flight.lcmlog --out flight.png
  "$vantage" log fit-motion flight.lcmlog --json --out motion.svg | json 'len(d["models"])' | grep -q 3 ||
    fail "fit-motion with its plot"
  "$vantage" log fit-ranges ranges.csv --poses way.csv --beacons survey.csv --out beacons.svg > /dev/null
  [[ -s flight.png && -s motion.svg && -s beacons.svg ]] || fail "plot"
fi
echo quit | "$vantage" log play flight.lcmlog --url memq:// --paused --json | json 'd["published"]' \
  | grep -qx 0 || fail "play"
"$vantage" log play flight.lcmlog --url memq:// --speed 64 --to-s 20 --json < /dev/null \
  | json 'd["published"] > 100' | grep -q True || fail "play"
echo "log_commands: all good"
