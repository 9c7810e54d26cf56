#!/bin/bash
# crowd.sh [SECONDS [READERS [STALLED]]]: flies config/lab.yaml for SECONDS (600) and serves it by
# `vantage view`. READERS viewers (2) read all records, STALLED viewers (1) never read.
# Every 10 s prints the server's memory and the data received by the first reader; at the end prints
# the trial's summary. Runs in a separate network namespace and leaves no files behind.
# BIN: the folder of the programs, build/release/bin unless set.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [[ "${CROWD_INSIDE:-}" == "" ]]; then
  CROWD_INSIDE=yes exec test/integration/in_network.sh "$PWD/test/rig/crowd.sh" "$@"
fi
seconds=${1:-600} readers=${2:-2} stalled=${3:-1}
bin=${BIN:-build/release/bin}
dir=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$dir"' EXIT
url='udpm://239.255.76.67:7667?ttl=0'

"$bin/vantage" up config/lab.yaml --duration-s $((seconds + 10)) --url "$url" --no-log --json \
  >"$dir/up.json" 2>"$dir/up.err" & up=$!
if ((readers + stalled > 0)); then
  "$bin/vantage" view --url "$url" --port 0 >"$dir/view.out" & view=$!
  until address=$(grep -o 'ws://[0-9.:]*' "$dir/view.out"); do
    kill -0 "$view" || { cat "$dir/view.out"; exit 1; }
    sleep 0.1
  done
  node test/view/peer/crowd.mjs "$address" "$seconds" "$readers" "$stalled" >"$dir/crowd" &
  echo "elapsed_s rss_kib threads reader_1_messages reader_1_mib stalled_open"
  began=$SECONDS
  while ((SECONDS - began < seconds)); do
    sleep 10
    awk -v elapsed=$((SECONDS - began)) '/^VmRSS/ {rss = $2} /^Threads/ {threads = $2}
      END {printf "%d %d %d ", elapsed, rss, threads}' "/proc/$view/status"
    python3 -c '
import json, sys
lines = open(sys.argv[1]).read().splitlines()
last = json.loads(lines[-1]) if lines else None
print(*((last["readers"][0]["messages"], round(last["readers"][0]["bytes"] / 2**20, 1),
         last["stalled_open"]) if last else ("-", "-", "-")))' "$dir/crowd"
  done
  tail -n 1 "$dir/crowd"
fi
wait "$up" || echo "vantage up ended with $?"
cat "$dir/up.err" "$dir/up.json"
