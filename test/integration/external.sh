#!/bin/bash
# external.sh BIN_DIR SCENARIO PYTHON EXAMPLE LCMTYPES: runs a signed flight of three robots with plans from
# external planners. EXAMPLE answers Q1 and is killed (signal 9) in flight; Q2's answers are too late; Q3's
# answers cannot be flown. Every plan must be in time (unless an overloaded host delayed the flight), no
# bodies may collide, each answer must be counted by its kind, and a replay of the log must reproduce every
# plan. Runs in its own network.
. "$(dirname "$0")/up_support.sh"
python=$3 example=$4 types=$5 here=$(dirname "$0")
lcm-gen --python --ppath "$dir/py" "$types"/*.lcm
export PYTHONPATH="${PYTHONPATH:-}:$dir/py"
"$bin/vantage" keys new "$dir/keys"
{ sed 's/algorithm: arvi /algorithm: external /' "$scenario"
  echo "security: {mode: require, keys: $dir/keys}"; } > "$dir/external.yaml"

start_witness
"$bin/vantage" up "$dir/external.yaml" --duration-s 25 --url "$url" --log "$dir/flight.lcmlog" --json \
  > "$dir/up.json" 2> "$dir/up.err" & up=$!
"$python" "$example" "$dir/external.yaml" Q1 2> "$dir/policy.err" & policy=$!
"$python" "$here/external_faults.py" "$dir/external.yaml" 2> "$dir/faults.err" & faults=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "no robot publishes plans"
sleep_until() { until_true 30 plans_go_on "$dir/witness.lcmlog" "$1" Q1 Q2 Q3; }
for _ in 1 2 3; do sleep_until "$(plans_in "$dir/witness.lcmlog")" || fail "not all robots continue to plan"; done
kill -9 "$policy"
for _ in 1 2; do sleep_until "$(plans_in "$dir/witness.lcmlog")" || fail "not all robots continue to plan without the policy"; done
status=0
wait "$up" || status=$?
cat "$dir/up.json" "$dir/up.err"
[[ $status == 0 ]] || fail "vantage up ended with $status"
kill -TERM "$witness" "$faults" 2>/dev/null || true
options=()
"$bin/hil_check" --held-up "$dir/flight.lcmlog" && options+=(--held-up)
"$python" "$here/external_check.py" "$dir/flight.lcmlog" "$dir/up.json" "${options[@]}" || fail "the flight differs from the expectation"
"$bin/vantage" log replay "$dir/flight.lcmlog" --node planner:Q1 --node planner:Q2 --node planner:Q3 ||
  fail "plans differ"
