#!/bin/bash
# replay.sh BIN_DIR SCENARIO SECONDS: flies SCENARIO with one process per node and lcm-logger, and kills all
# processes. Then replays the log with lcm-logplayer into one new estimator and one new planner, and
# compares their output. Runs in its own network: in_network.sh replay.sh …
# PLANNER, ESTIMATOR: other programs for the replay, such as those of build/arm64/bin.
. "$(dirname "$0")/up_support.sh"
seconds=$3
robot=Q2

"$bin/vantage" up "$scenario" --duration-s "$seconds" --url "$url" --log "$dir/flight.lcmlog" --json \
  > "$dir/up.json"
cat "$dir/up.json"; echo
grep -q '"messages_lost": *0[,}]' "$dir/up.json" || { echo "messages were lost"; exit 1; }

lcm-logger -q -f -c 'REPLAY_(BELIEF|PLAN)_.*' --lcm-url="$url" "$dir/again.lcmlog" & logger=$!
"${ESTIMATOR:-$bin/vantage-estimator}" --scenario "$scenario" --robot "$robot" --url "$url" --replay \
  --publish-prefix REPLAY_ & estimator=$!
"${PLANNER:-$bin/vantage-planner}" --scenario "$scenario" --robot "$robot" --url "$url" --replay \
  --publish-prefix REPLAY_ & planner=$!
# A process has joined the multicast group when the kernel lists its socket on the port. Waits until the
# logger, the estimator and the planner have joined.
for _ in $(seq 200); do
  [[ $(grep -c ':1DF3 ' /proc/net/udp) -ge 3 ]] && break
  sleep 0.1
done
lcm-logplayer -l "$url" "$dir/flight.lcmlog" > /dev/null
# A step that lacks an input is skipped after two seconds of ticks. Waits until the log stops growing.
size=-1
until [[ $(stat -c %s "$dir/again.lcmlog") == "$size" ]]; do
  size=$(stat -c %s "$dir/again.lcmlog")
  sleep 3
done
kill -TERM "$estimator" "$planner"; wait "$estimator" "$planner"
kill -TERM "$logger"; wait "$logger" || true
"$bin/replay_check" "$dir/flight.lcmlog" "$dir/again.lcmlog" "$robot" $((seconds / 2))
# Replays with the user's command: the same nodes on the log alone.
"$bin/vantage" log replay "$dir/flight.lcmlog" --node "planner:$robot" --node "estimator:$robot"
