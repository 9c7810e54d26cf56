#!/bin/bash
# kill9.sh BIN_DIR SCENARIO: flies SCENARIO, kills (signal 9) one process of each kind in turn, including
# the logger, and stops (SIGSTOP) another. Each must be restarted, all robots must continue to plan, the log
# must be complete and contain the last messages, and losses must be reported. Runs in its own network:
# in_network.sh kill9.sh …
. "$(dirname "$0")/up_support.sh"

start_witness
"$bin/vantage" up "$scenario" --duration-s 300 --url "$url" --log "$dir/flight.lcmlog" --json \
  > "$dir/up.json" 2> "$dir/up.err" & up=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "no robot publishes plans"

kill_and_see() {
  local pattern=$1 signal=${2:-9} old new plans
  old=$(child_of "$up" "$pattern")
  [[ -n $old ]] || fail "no process '$pattern'"
  kill "-$signal" "$old"
  new_one() { new=$(child_of "$up" "$pattern"); [[ -n $new && $new != "$old" ]]; }
  until_true 20 new_one || fail "'$pattern' is not restarted"
  plans=$(plans_in "$dir/witness.lcmlog")
  until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 ||
    fail "not all robots plan after '$pattern' was killed: $plans, then $(plans_in "$dir/witness.lcmlog")"
}
kill_and_see 'vantage-sim '
kill_and_see 'vantage-sensor .*--robot Q1'
kill_and_see 'vantage-estimator .*--robot Q2'
kill_and_see 'vantage-planner .*--robot Q3'
kill_and_see 'vantage log record '
# Stops the process instead of killing it: the process exists but does nothing.
kill_and_see 'vantage-planner .*--robot Q1' STOP
grep -q 'planner Q1 sent no heartbeat' "$dir/up.err" || fail "the stopped planner was not reported"

status=0
kill -INT "$up"
wait "$up" || status=$?
cat "$dir/up.err" "$dir/up.json"
# The simulation was restarted, so `vantage up` must end with exit code 1; the checks below allow no other
# error.
[[ $status == 1 ]] || fail "vantage up ended with $status, not 1"
"$bin/vantage" log check "$dir/flight.lcmlog" || fail "the log is damaged"
python3 - "$dir/up.json" <<'PYTHON' || fail "the report is wrong"
import json, sys
report = json.loads(open(sys.argv[1]).readlines()[-1])
fallen = {p["name"]: p for p in report["processes"]}
assert set(fallen) == {"sim", "sensor Q1", "estimator Q2", "planner Q1", "planner Q3",
                       "recorder"}, fallen
for name, process in fallen.items():
    assert process["restarts"] == 1 and process["last_end"] == "signal 9", process
    assert 0 < process["down_s"] < 10, process
assert report["restarts"] == 6 and report["given_up"] == [] and report["killed"] == []
assert report["ended_badly"] == []
assert report["world_restarts"] == 1
assert report["log"]["restarts"] == 1 and report["log"]["is_to_the_end"]
assert report["log"]["unrecorded_s"] > 0
print("stopped in", report["stop_s"], "s; not recorded for", report["log"]["unrecorded_s"], "s;",
      report["plans_missing"], "plans missing of", report["rounds"], "rounds of 3")
PYTHON
# Messages that only the witness recorded were sent while the logger was down.
"$bin/vantage" log export "$dir/flight.lcmlog" --to csv --out "$dir/csv" --channels 'HEALTH_.*'
for counter in process.cpu_us process.memory_bytes process.memory_most_bytes; do
  grep -q "$counter" "$dir"/csv/HEALTH_PLANNER_Q1.csv || fail "HEALTH has no $counter"
done
kill -TERM "$witness"
echo "plans received: $(plans_in "$dir/witness.lcmlog"); recorded: $(plans_in "$dir/flight.lcmlog")"
