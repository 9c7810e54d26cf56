#!/bin/bash
# upgrade.sh VANTAGE RELEASES: checks that this version reads the logs of earlier versions in
# RELEASES, and that it accepts or refuses their scenario files as RELEASES/README.md describes.
set -euo pipefail
vantage=$1
releases=$(cd "$2" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
fail() { echo "upgrade: $1" >&2; exit 1; }

read_log() {  # checks that log $1 is whole, has no outdated type, and can be evaluated and exported
  "$vantage" log check "$1" > said || { cat said; fail "$1: is damaged"; }
  "$vantage" log info "$1" --json > info.json
  "$vantage" log metrics "$1" --json > metrics.json
  "$vantage" log export "$1" --to csv --raw --out csv > csv.txt
  "$vantage" log export "$1" --to mcap --messages-only --out all.mcap > mcap.txt
  python3 - "$1" << 'PY'
import csv
import json
import pathlib
import sys
info = json.load(open("info.json"))
for name, channel in info["channels"].items():
    assert channel["type"] and channel["other_types"] == 0, (sys.argv[1], name, channel)
metrics = json.load(open("metrics.json"))
assert metrics["rounds"] > 0 and metrics["plans_missing"] == 0, metrics
assert metrics["rmse_m"] is not None and metrics["discovered"] > 0, metrics
assert metrics["messages_lost"] == 0, metrics
for told in ("csv.txt", "mcap.txt"):
    assert f": {info['events']} messages" in open(told).read(), (told, info["events"])
tables = {path.stem: len(list(csv.reader(open(path)))) - 1 for path in pathlib.Path("csv").iterdir()}
assert tables.keys() == info["channels"].keys(), tables
assert all(rows >= info["channels"][name]["events"] for name, rows in tables.items()), tables
PY
}

judge_scenario() {  # expects FILE to be accepted, or refused with the text of NAME.refused
  local status=0
  "$vantage" check "$1" > said 2>&1 || status=$?
  local refused=${1%.yaml}.refused
  if [[ -e "$refused" ]]; then
    [[ $status == 2 ]] || { cat said; fail "$1: is accepted, but must be rejected as in $refused"; }
    grep -qF "$(cat "$refused")" said || { cat said; fail "$1: is not rejected with the message in $refused"; }
  elif [[ $status == 2 ]]; then  # 1: valid, but this machine cannot fly it
    cat said
    fail "$1: is refused"
  fi
}

logs=0 scenarios=0
for release in "$releases"/*/; do
  for packed in "$release"*.lcmlog.xz; do
    [[ -f "$packed" ]] || continue
    name=$(basename "$packed" .xz)
    xz --decompress --stdout "$packed" > "$name"
    read_log "$name"
    rm -r "$name" csv all.mcap
    logs=$((logs + 1))
  done
  for scenario in "$release"*.yaml; do
    [[ -f "$scenario" ]] || continue
    judge_scenario "$scenario"
    scenarios=$((scenarios + 1))
  done
done
((logs > 0 && scenarios > 1)) || fail "nothing to read in $releases"
echo "upgrade: $logs logs and $scenarios scenarios of earlier versions"
