#!/bin/bash
# attack.sh BIN_DIR SCENARIO SECONDS PROPOSALS: flies SCENARIO. Its robots publish proposals on the channels
# PROPOSALS_R before they plan. One robot is jammed from 4 s on, and the planner of another robot is killed
# (signal 9). The planner must be restarted, all robots must continue to propose and plan, no two bodies may
# come too close, and a replay of the log must reproduce every plan and every proposal. Runs in its own
# network: in_network.sh attack.sh …
. "$(dirname "$0")/up_support.sh"
seconds=$3 proposals=$4
sed 's/from_s: [0-9]*/from_s: 4/' "$scenario" > "$dir/scenario.yaml"

start_witness
"$bin/vantage" up "$dir/scenario.yaml" --duration-s "$seconds" --url "$url" \
  --log "$dir/flight.lcmlog" --json > "$dir/up.json" 2> "$dir/up.err" & up=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "no robot publishes plans"
old=$(child_of "$up" 'vantage-planner .*--robot Q2')
[[ -n $old ]] || fail "no planner of Q2"
kill -9 "$old"
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 ||
  fail "not all robots publish plans after a planner was killed"
status=0
wait "$up" || status=$?
cat "$dir/up.json" "$dir/up.err"
[[ $status == 0 ]] || fail "vantage up ended with $status"
kill -TERM "$witness"

"$bin/vantage" log check "$dir/flight.lcmlog" || fail "the log is damaged"
"$bin/vantage" log info "$dir/flight.lcmlog" --json > "$dir/info.json"
python3 - "$dir" "$proposals" <<'PYTHON' || fail "the flight differs from the expectation"
import json, sys
dir, proposals = sys.argv[1:]
report = json.loads(open(dir + "/up.json").readlines()[-1])
fallen = {p["name"]: p for p in report["processes"]}
assert set(fallen) == {"planner Q2"} and fallen["planner Q2"]["restarts"] == 1, fallen
assert report["collisions"] == 0 and report["separation_violations"] == 0, report
events = {name: c["events"] for name, c in json.load(open(dir + "/info.json"))["channels"].items()}
for robot in ("Q1", "Q2", "Q3"):
    assert events[f"{proposals}_{robot}"] >= 1, events
assert events["ATTACK"] >= 1
print({name: count for name, count in events.items() if "PLAN" in name or "PROPOSAL" in name})
PYTHON
# The replay must be exact. An output that depends on a message that was not recorded cannot be reproduced.
"$bin/vantage" log replay "$dir/flight.lcmlog" --node planner:Q1 --node planner:Q2 \
  --node planner:Q3 || fail "plans or proposals differ"
