#!/bin/bash
# beside.sh BIN_DIR SCENARIO: while a trial runs, a second trial of the same scenario and the replay of a
# log are refused on its network, and the first trial is not affected. To be run in its own network.
. "$(dirname "$0")/up_support.sh"
url='udpm://239.255.76.67:7667?ttl=0'
start_witness
"$bin/vantage" up "$scenario" --url "$url" --duration-s 300 --log "$dir/flight.lcmlog" \
  --json > "$dir/up.json" 2> "$dir/up.err" & up=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "not all robots publish plans"

refused() {
  local want=$1; shift
  local status=0
  "$@" > "$dir/second.out" 2> "$dir/second.err" < /dev/null || status=$?
  [[ $status == 2 ]] || fail "'$*' exits with $status instead of 2"
  grep -q "$want" "$dir/second.err" || fail "'$*' does not print '$want'"
}
refused 'another .vantage up. runs on this network' \
  "$bin/vantage" up "$scenario" --url "$url" --no-log
cp "$dir/flight.lcmlog" "$dir/old.lcmlog"
refused 'is alive on this network\|runs on this network' \
  "$bin/vantage" log play "$dir/old.lcmlog" --url "$url"
"$bin/vantage" log play "$dir/old.lcmlog" --url "$url" --prefix OLD_ --speed 64 < /dev/null ||
  fail "a log with other names is rejected"

plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 || fail "not all robots publish plans again"
kill -INT "$up"
wait "$up" || fail "the trial ended with $?"
! grep -q 'another' "$dir/up.err" || fail "the trial received messages of another program"
cat "$dir/up.json"
