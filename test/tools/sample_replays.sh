#!/bin/bash
# sample_replays.sh VANTAGE SAMPLE.xz: checks that a replay reproduces the sample log's plans and
# beliefs bit for bit.
set -euo pipefail
vantage=$1 sample=$2
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
xz --decompress --stdout "$sample" > "$dir/sample.lcmlog"
"$vantage" log replay "$dir/sample.lcmlog" || {
  echo "planner or estimator decide otherwise than when the sample was recorded; when that is meant," \
    "run logs/sample/record.sh" >&2
  exit 1
}
