#!/usr/bin/env bash
# parallel.sh VANTAGE: checks that shards run by GNU parallel give the same bytes as one run, as
# described in docs/guide/experiments.md. Exit code 77: GNU parallel is missing.
set -euo pipefail
vantage=$1
parallel --version 2> /dev/null | grep -q '^GNU parallel' || {
  echo "skipped: no GNU parallel (tools/setup --cluster)"
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$vantage" experiment dls-objective --smoke --out "$work/one" > /dev/null
parallel --jobs 2 "$vantage" experiment dls-objective --smoke --out "$work/shards" \
  --shard {}/4 ::: $(seq 4) > "$work/out"
(($(grep -c '^shard ' "$work/out") == 4)) || { cat "$work/out"; exit 1; }
"$vantage" experiment dls-objective --smoke --out "$work/shards" > /dev/null
(($(find "$work/shards/rows" -type f | wc -l) == 4)) || { echo "collecting ran units"; exit 1; }
diff -r -x rows -x manifest.json -x 'times.*' "$work/one" "$work/shards"
