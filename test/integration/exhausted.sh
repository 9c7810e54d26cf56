#!/bin/bash
# exhausted.sh BIN_DIR SCENARIO: starts each process with too few descriptors, too little memory or no
# available thread. The process must report the missing resource and end, or serve until it is requested to
# end, without a crash or a hang. Runs in its own network.
. "$(dirname "$0")/up_support.sh"
processes=("vantage-sim" "vantage-contacts" "vantage-sensor --robot Q1" "vantage-estimator --robot Q1"
  "vantage-planner --robot Q1")

# run_within LIMIT VALUE PROGRAM…: returns 0 if PROGRAM served for one second under the limit and then ended
# on request.
run_within() {
  local status=0
  (
    for open in /proc/self/fd/*; do  # descriptors inherited from the parent of the test
      ((${open##*/} <= 2)) || eval "exec ${open##*/}>&-"
    done
    ulimit "$1" "$2"
    exec "$bin"/${*:3} --scenario "$scenario" --url "$url"
  ) > "$dir/out" 2> "$dir/said.err" & local child=$!
  for _ in 1 2 3 4 5 6 7 8 9 10; do
    kill -0 "$child" 2> /dev/null || break
    sleep 0.1
  done
  kill -INT "$child" 2> /dev/null || true
  wait "$child" || status=$?
  [[ $status == 0 || -s $dir/said.err ]] || fail "${*:3} with $1 $2 exits with $status without a message"
  [[ $status == 0 || $status == 1 || $status == 2 ]] || fail "${*:3} with $1 $2 ends with $status"
  echo "${*:3}, $1 $2: $status $(head -c 100 "$dir/said.err" | head -1)"
}

for process in "${processes[@]}"; do
  # Needed: standard input, output and error, two sockets, and one descriptor to query the route.
  for descriptors in 4 5 6; do
    # shellcheck disable=SC2086
    run_within -n "$descriptors" $process
    if ((descriptors < 6)); then
      grep -q 'cannot create a socket: Too many open files' "$dir/said.err" ||
        fail "$process with $descriptors descriptors does not report the missing resource"
    fi
  done
  for kib in 40000 60000 100000; do
    # shellcheck disable=SC2086
    run_within -v "$kib" $process
  done
done
run_within -v 60000 vantage-planner --robot Q1
grep -q 'out of memory' "$dir/said.err" || fail "the planner does not report that memory is exhausted"
