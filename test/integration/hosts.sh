#!/bin/bash
# hosts.sh BIN_DIR SCENARIO: flies SCENARIO on two hosts with a cable between them. The host AIR is ended
# and restarted, then killed and restarted; then the cable is removed and put back. The host LAB must report
# each event and restart nothing, and all robots must continue to plan. Runs in its own network:
# in_network.sh hosts.sh …
. "$(dirname "$0")/up_support.sh"
url='udpm://239.255.76.67:7667?ttl=1'  # over the cable
cat "$scenario" - > "$dir/two.yaml" <<'YAML'
hosts:
  - {name: LAB, runs: [sim, logger, Q1]}
  - {name: AIR, runs: [Q2, Q3]}
YAML

# AIR has a separate network; this script runs in that of LAB.
unshare -n sleep 600 &
air_network=$!
in_air=(nsenter --target "$air_network" --net)
has_own_network() {
  [[ "$(readlink /proc/$air_network/ns/net)" != "$(readlink /proc/self/ns/net)" ]]
}
until_true 10 has_own_network || fail "AIR has no separate network"
ip link add lab type veth peer name air netns "$air_network"
ip address add 192.0.2.1/24 dev lab
ip link set lab up
ip route replace 224.0.0.0/4 dev lab
"${in_air[@]}" sh -e -c 'ip link set lo up
  ip address add 192.0.2.2/24 dev air
  ip link set air up
  ip route add 224.0.0.0/4 dev air'

start() {
  local on=()
  [[ $1 != AIR ]] || on=("${in_air[@]}")
  "${on[@]}" "$bin/vantage" up "$dir/two.yaml" --duration-s 300 --url "$url" --host "$1" "${@:3}" \
    --json > "$dir/$2.json" 2> "$dir/$2.err" &
}
said() { grep -q "$2" "$dir/$1.err"; }

if "$bin/vantage" up "$dir/two.yaml" --no-log 2> "$dir/none.err"; then
  fail "vantage up ran without --host"
fi
grep -q 'has the hosts LAB, AIR' "$dir/none.err" || fail "the missing option is not named"

start_witness
start AIR air1; air=$!  # the other host is down, so either host may start first
start LAB lab --log "$dir/flight.lcmlog"; lab=$!
until_true 30 plans_go_on "$dir/witness.lcmlog" "" Q1 Q2 Q3 || fail "not all robots publish plans"
until_true 20 said lab 'host AIR is up' || fail "LAB does not report that AIR is up"

kill -TERM "$air"
wait "$air" || fail "AIR ended with $?"
until_true 20 said lab 'host AIR has been silent' || fail "LAB does not report that AIR is silent"
start AIR air2; air=$!
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 said lab 'host AIR was started again' || fail "LAB does not report the restart of AIR"
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 || fail "not all robots publish plans again"

# When a supervisor is killed, its processes end too: no process continues without a supervisor.
planner=$(child_of "$air" 'vantage-planner .*--robot Q2')
kill -9 "$air"
wait "$air" || true
gone() { ! kill -0 "$planner" 2>/dev/null; }
until_true 20 gone || fail "a planner still runs without its supervisor"
start AIR air3; air=$!
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 || fail "not all robots publish plans a third time"

# Without the cable each host continues alone; with the cable the hosts receive each other again.
"${in_air[@]}" ip link set air down
until_true 20 said air3 'host LAB has been silent' || fail "AIR does not report that LAB is silent"
"${in_air[@]}" sh -e -c 'ip link set air up; ip route add 224.0.0.0/4 dev air'
until_true 20 said air3 'host LAB is received again' || fail "AIR does not report that LAB is back"
plans=$(plans_in "$dir/witness.lcmlog")
until_true 20 plans_go_on "$dir/witness.lcmlog" "$plans" Q1 Q2 Q3 ||
  fail "not all robots publish plans after the cable was reconnected"

kill -INT "$lab" "$air"
wait "$air" || fail "AIR ended with $?"
wait "$lab" || fail "LAB ended with $?"
cat "$dir"/lab.err "$dir"/lab.json
"$bin/vantage" log check "$dir/flight.lcmlog" || fail "the log is damaged"
grep -q '"restarts":0' "$dir/lab.json" || fail "a process was restarted on LAB"
"$bin/vantage" log info "$dir/flight.lcmlog" | grep -E 'HOST_(LAB|AIR)' || fail "no HOST_ channels"
