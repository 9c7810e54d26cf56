#!/usr/bin/env bash
# experiments.sh VANTAGE: checks that every experiment runs, as a whole and in shards, and continues
# after kill -9.
source "$(dirname "$0")/begin.sh"

# Compares all files that must not depend on how the experiment was run.
same() {
  diff -r -x rows -x manifest.json -x 'times.*' "$1" "$2" || fail "$1 and $2 differ"
}

mapfile -t names < <("$vantage" experiment --help | sed -n '/^Experiments:/,/^The same/p' |
  sed -n 's/^  \([a-z-]*\) .*/\1/p')
((${#names[@]} >= 4)) || fail "the help names only: ${names[*]}"

for name in "${names[@]}"; do
  begin=$SECONDS
  "$vantage" experiment "$name" --smoke --jobs 2 --out "$work/$name" > "$work/out"
  echo "$name: $((SECONDS - begin)) s"
  for file in report.md manifest.json times.csv; do
    [[ -s "$work/$name/$file" ]] || fail "$name: no $file"
  done
  # Each picture of the report must exist if gnuplot is installed.
  if command -v gnuplot > /dev/null; then
    for png in $(sed -n 's/^!\[.*\](\(.*\))$/\1/p' "$work/$name/report.md"); do
      [[ -s "$work/$name/$png" && -s "$work/$name/${png%.png}.svg" ]] || fail "$name: no $png"
    done
    grep -q '^figures in' "$work/out" || fail "$name: $(cat "$work/out")"
  fi
done

# Shards, on one machine or on many, must give the same bytes. Collecting them must run nothing.
for i in 1 2 3; do
  "$vantage" experiment dls-objective --smoke --shard "$i/3" --out "$work/shards" > "$work/out"
  grep -q "^shard $i/3: 2 units done" "$work/out" || fail "shard $i: $(cat "$work/out")"
done
"$vantage" experiment dls-objective --smoke --out "$work/shards" > "$work/out"
[[ $(find "$work/shards/rows" -type f | wc -l) == 3 ]] || fail "collecting ran units"
same "$work/dls-objective" "$work/shards"

# Kills the run as soon as one row exists. The same command must continue the run and give the same bytes.
"$vantage" experiment dls-objective --smoke --out "$work/killed" > "$work/out" &
pid=$!
until [[ $(cat "$work"/killed/rows/*.jsonl 2> /dev/null | wc -l) -ge 2 ]]; do
  kill -0 "$pid" 2> /dev/null || break
done
kill -9 "$pid" 2> /dev/null || true
wait "$pid" 2> /dev/null || true
lines=$(cat "$work"/killed/rows/*.jsonl | wc -l)
printf '{"setting":"3","trial":1,"rows":{"tri' >> "$(echo "$work"/killed/rows/*.jsonl)"
"$vantage" experiment dls-objective --smoke --out "$work/killed" > "$work/out"
again=$(cat "$(ls -t "$work"/killed/rows/*.jsonl | head -1)" | wc -l)
# Each file begins with one line about the process; the two files contain six units in total.
((lines == 7 || lines - 1 + again - 1 == 6)) || fail "$lines lines before and $again after"
same "$work/dls-objective" "$work/killed"

# Ctrl-C ends the run, keeps the rows and prints how to continue.
"$vantage" experiment dls-objective --seed 9 --out "$work/stopped" > "$work/out" 2> "$work/err" &
pid=$!
until [[ -n "$(ls "$work"/stopped/rows 2> /dev/null)" ]]; do
  kill -0 "$pid" || fail "the run ended before the signal: $(cat "$work/err")"
done
kill -INT "$pid"
code=0
wait "$pid" || code=$?
[[ $code == 1 ]] || fail "Ctrl-C gave exit code $code"
grep -q 'rows are kept. To continue: vantage experiment dls-objective --seed 9 --trials 50 --out' \
  "$work/err" || fail "output after Ctrl-C: $(cat "$work/err")"

# A directory of another run is refused; the message states the rule.
code=0
"$vantage" experiment dls-objective --smoke --seed 2 --out "$work/shards" 2> "$work/err" || code=$?
[[ $code == 2 ]] || fail "a directory with a different seed gave exit code $code"
grep -q 'different seed' "$work/err" || fail "wrong message: $(cat "$work/err")"

# Invalid shards.
for shard in 0/3 4/3 3 1/0 1/3x; do
  code=0
  "$vantage" experiment dls-objective --smoke --shard "$shard" --out "$work/none" 2> "$work/err" || code=$?
  [[ $code == 2 ]] && grep -q 'is not i/n' "$work/err" || fail "--shard $shard: exit code $code"
done
[[ ! -e "$work/none" ]] || fail "a rejected command created its directory"

# If Slurm is requested but not installed, an error is reported and nothing is run.
code=0
PATH=/nonexistent "$vantage" experiment dls-objective --smoke --slurm --out "$work/slurm" \
  2> "$work/err" || code=$?
[[ $code == 2 ]] && grep -q 'sbatch: No such file .*run --slurm on a machine' "$work/err" ||
  fail "without Slurm: exit code $code, $(cat "$work/err")"
[[ ! -e "$work/slurm/rows" ]] || fail "units ran without Slurm"
