#!/bin/bash
# switch_trial.sh BIN_DIR SCENARIO: runs a trial on two hosts over a switch that loses every tenth frame,
# duplicates some and reorders others. No bodies may collide, all robots must continue to plan, losses must
# be counted, and the log must be complete. Runs in its own network: in_network.sh switch_trial.sh …
. "$(dirname "$0")/up_support.sh"

{
  sed 's/ttl=0"/ttl=1"/' "$scenario"
  printf '\nhosts:\n  - {name: LAB, runs: [sim, vicon, logger]}\n  - {name: AIR, runs: [Q1, Q2, Q3]}\n'
} > "$dir/trial.yaml"
up() { echo "$bin/vantage up $dir/trial.yaml --duration-s 25 --json --host $1"; }
# shellcheck disable=SC2046
"$(dirname "$0")/../../test/rig/switch" --seed 1 --loss 0.1 --duplicate 0.05 --reorder 0.2 --reorder-s 0.05 \
  -- $(up LAB) --log "$dir/flight.lcmlog" -- $(up AIR) > "$dir/out" 2> "$dir/up.err" ||
  fail "a host exits with $?"
cat "$dir/out"
"$bin/vantage" log check "$dir/flight.lcmlog" || fail "the log is damaged"
python3 - "$dir/out" <<'PYTHON' || fail "the trial differs from the expectation"
import json, sys
lab, air, switch = (json.loads(line) for line in open(sys.argv[1]) if line.startswith("{"))
for host in lab, air:
    assert host["collisions"] == 0 and host["min_separation_m"] > 0.5, host["min_separation_m"]
    assert host["messages_lost"] > 0, "no lost messages are counted"
    assert host["plans"] >= 0.7 * 3 * host["rounds"], (host["plans"], host["rounds"])
for way in "1-2", "2-1":
    assert 0.07 < switch[way]["lost"] / switch[way]["frames"] < 0.13 and switch[way]["doubled"] > 0
PYTHON
