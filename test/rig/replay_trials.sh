#!/bin/bash
# replay_trials.sh [TRIALS [STRESSED [SECONDS [SCENARIO]]]]: flies TRIALS real-time trials of SCENARIO
# with one process per node (`vantage up`) and seeds from 1. The last STRESSED trials run with stress-ng on
# every core. Computes all plans and beliefs again from the logs (`vantage log replay`) and prints a
# table. Exit code 1 unless all outputs are bit-identical. Defaults: 10, 2, 30 s, config/lab.yaml.
# Runs in a separate network namespace and leaves no files behind.
# BIN: the folder of the programs, build/release/bin unless set.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [[ -z "${REPLAY_INSIDE:-}" ]]; then
  REPLAY_INSIDE=yes exec test/integration/in_network.sh "$PWD/test/rig/replay_trials.sh" "$@"
fi
trials=${1:-10} stressed=${2:-2} seconds=${3:-30} scenario=${4:-config/lab.yaml}
bin=${BIN:-build/release/bin}
dir=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$dir"' EXIT
url='udpm://239.255.76.67:7667?ttl=0'
if ((stressed > 0)) && ! command -v stress-ng >/dev/null; then
  echo "stress-ng is not installed (apt-get install stress-ng)" >&2
  exit 2
fi

echo "| trial | load | rounds | late | messages lost | plans: logged | recomputed | different | not compared | beliefs: logged | recomputed | different | not compared |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
status=0
for trial in $(seq "$trials"); do
  beside=- stress=
  if ((trial > trials - stressed)); then
    beside="stress-ng, $(nproc) cores"
    stress-ng --cpu "$(nproc)" --timeout $((seconds + 10)) >/dev/null 2>&1 & stress=$!
  fi
  # Exit code 1 (for example after a collision) is ignored here: only the log is used.
  "$bin/vantage" up "$scenario" --seed "$trial" --duration-s "$seconds" --url "$url" --json \
    --log "$dir/flight.lcmlog" >"$dir/up.json" 2>"$dir/up.err" || (($? == 1))
  if [[ -n "$stress" ]]; then
    kill "$stress" 2>/dev/null || true
    wait "$stress" || true
  fi
  "$bin/vantage" log replay "$dir/flight.lcmlog" --json >"$dir/replay.json" 2>/dev/null || status=1
  python3 - "$trial" "$beside" "$dir/up.json" "$dir/replay.json" <<'PYTHON'
import json
import sys

trial, beside, up, replay = sys.argv[1:]
up, replay = (json.load(open(path)) for path in (up, replay))
cells = [trial, beside, up["rounds"], up["rounds_late"], up["messages_lost"]]
for kind in "planner", "estimator":
    nodes = [node for node in replay["nodes"] if node["node"].startswith(kind)]
    cells += [sum(node[key] for node in nodes)
              for key in ("logged", "replayed", "different", "not_replayed")]
print("| " + " | ".join(map(str, cells)) + " |")
for node in replay["nodes"]:
    if node["first_difference"] or node["unexpected"]:
        print(node, file=sys.stderr)
PYTHON
  rm -f "$dir"/flight.lcmlog*
done
exit $status
