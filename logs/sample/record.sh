#!/bin/bash
# record.sh [VANTAGE]: records lab_60s.lcmlog.xz again with the release build or with VANTAGE (any
# build gives the same bytes) and replays it. Needed after a change of the planner's or estimator's
# decisions; the test tools.sample_replays then fails.
set -euo pipefail
cd "$(dirname "$0")"
vantage=$(realpath "${1:-../../build/release/bin/vantage}")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
sed 's/rate_hz: 50/rate_hz: 20/' ../../config/lab.yaml > "$dir/lab-20hz.yaml"
"$vantage" trial "$dir/lab-20hz.yaml" --seed 1 --duration-s 60 --log "$dir/lab_60s.lcmlog"
"$vantage" log replay "$dir/lab_60s.lcmlog"
xz -9 --stdout "$dir/lab_60s.lcmlog" > lab_60s.lcmlog.xz
size=$(stat -c %s lab_60s.lcmlog.xz)
((size < 1000000)) || { echo "lab_60s.lcmlog.xz has $size bytes; a sample has less than 1000000" >&2; exit 1; }
