#!/bin/bash
# mapping.sh BIN_DIR SCENARIO SECONDS: runs a team that maps, with one process per node, while the scenario
# jams a robot; one planner is killed (signal 9) in flight. All robots must continue to plan, the
# uncertainty of the map must decrease, and a replay must reproduce every plan, belief and map of the log
# bit for bit. Runs in its own network: in_network.sh mapping.sh …
. "$(dirname "$0")/up_support.sh"
seconds=$3

start_witness
"$bin/vantage" up "$scenario" --duration-s "$seconds" --url "$url" --log "$dir/flight.lcmlog" \
  --json > "$dir/up.json" 2> "$dir/up.err" & up=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "no robot publishes plans"
old=$(child_of "$up" 'vantage-planner .*--robot Q2')
kill -9 "$old"
new_one() { new=$(child_of "$up" 'vantage-planner .*--robot Q2'); [[ -n $new && $new != "$old" ]]; }
until_true 20 new_one || fail "the planner is not restarted"
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 || fail "not all robots publish plans: $plans"
wait "$up" || fail "vantage up ended with $?"
cat "$dir/up.json"; echo
replays=()
for robot in Q1 Q2 Q3; do
  replays+=(--node "planner:$robot" --node "estimator:$robot")
done
"$bin/vantage" log replay "$dir/flight.lcmlog" "${replays[@]}" || fail "replayed outputs differ"
"$bin/vantage" log export "$dir/flight.lcmlog" --to csv --out "$dir/csv" \
  --channels 'MAP_.*' --channels 'SCAN_Q1'
python3 - "$dir" <<'PYTHON' || fail "the trial is wrong"
import csv, json, sys
csv.field_size_limit(1 << 30)
report = json.loads(open(sys.argv[1] + "/up.json").readlines()[-1])
assert report["collisions"] == 0 and report["separation_violations"] == 0, report
assert {p["name"] for p in report["processes"]} == {"planner Q2"}, report["processes"]
for robot in ("Q1", "Q2", "Q3"):
    rows = csv.DictReader(open(f"{sys.argv[1]}/csv/MAP_{robot}.csv"))  # one line per input
    nats = list({row["sequence"]: float(row["entropy_nat"]) for row in rows}.values())
    print(robot, "map entropy", nats[0], "to", nats[-1], "nat in", len(nats), "steps")
    assert nats[-1] < 0.8 * nats[0], robot
jammed = [row["jammed"] for row in csv.DictReader(open(sys.argv[1] + "/csv/SCAN_Q1.csv"))]
assert any(word not in ("0", "false") for word in jammed), set(jammed)
PYTHON
kill -TERM "$witness"
