#!/bin/bash
# hil.sh BIN_DIR SCENARIO SECONDS [ROBOT…]: flies SCENARIO with every process and driver on the
# network, from the ground and back to it, and checks the log; the robots named stay at their
# heights. To be run in a network of its own: in_network.sh hil.sh …
set -euo pipefail
bin=$1 scenario=$2 seconds=$3
level=("${@:4}")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

status=0
"$bin/vantage" up "$scenario" --fly --duration-s "$seconds" --log "$dir/flight.lcmlog" --json \
  > "$dir/up.json" 2> "$dir/up.err" || status=$?
cat "$dir/up.json" "$dir/up.err"
"$bin/hil_check" "$dir/flight.lcmlog" "${level[@]}"
if [[ $status != 0 ]]; then
  echo "vantage up ended with $status"
  exit 1
fi
