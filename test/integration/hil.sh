#!/bin/bash
# hil.sh BIN_DIR SCENARIO ROUNDS [ROBOT…]: flies SCENARIO with every process and driver on the network: from
# the ground, until each robot has followed plans of ROUNDS rounds, and back to the ground. Then checks the
# log. The named robots stay at their heights. Runs in its own network: in_network.sh hil.sh …
. "$(dirname "$0")/up_support.sh"
rounds=$3
level=("${@:4}")

"$bin/vantage" up "$scenario" --fly --ignore-load --log "$dir/flight.lcmlog" --json > "$dir/flight.json" 2> "$dir/flight.err" &
up=$!
have_flown() { [[ -e $dir/flight.lcmlog ]] && "$bin/hil_check" --flown "$rounds" "$dir/flight.lcmlog"; }
give_up=$((SECONDS + 110))
while ((SECONDS < give_up)); do
  kill -0 "$up" 2>/dev/null || break
  have_flown && break
  sleep 1
done
kill -INT "$up" 2>/dev/null || true
status=0
wait "$up" || status=$?
cat "$dir/flight.json" "$dir/flight.err"
# The emulated autopilots limit their estimated speed to 1.15 times the limit. In flights of lab-hil with
# seeds 1 to 3, without other load, the true speed reached 1.14 to 1.173 times the limit. Their drivers stop
# them at 1.3 times.
"$bin/hil_check" --strict --speed-share 1.25 "$dir/flight.lcmlog" "${level[@]}"
have_flown || "$bin/hil_check" --held-up "$dir/flight.lcmlog" || fail "not all robots have followed $rounds rounds"
if [[ $status != 0 ]] && ! is_machine_overload flight; then
  echo "vantage up ended with $status"
  exit 1
fi
