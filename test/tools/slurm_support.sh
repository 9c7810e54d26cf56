# Sourced instead of begin.sh by scripts that run within in_slurm.sh. $extent: the options that set the size
# of the experiment.
source "$(dirname "$0")/begin.sh"

# run CODE DIRECTORY OPTION…: expects exit code CODE; the output is in $work/out.
run() {
  local expected=$1 directory=$2
  shift 2
  begin "$directory" "$@"
  ended "$expected"
}
# begin DIRECTORY OPTION…: starts the run in the background, without waiting; its process is $pid.
begin() {
  what="$*"
  : > "$work/out"  # the previous run may have printed the same
  "$vantage" experiment heterogeneous "${extent[@]}" --out "$work/$1" "${@:2}" > "$work/out" 2>&1 &
  pid=$!
}
# ended CODE: waits for the run started by begin; expects exit code CODE.
ended() {
  local code=0
  wait "$pid" || code=$?
  [[ $code == "$1" ]] || fail "exit code $code of: $what"
}

says() { grep -q -- "$1" "$work/out" || fail "the output does not contain '$1'"; }
# Prints the numbers of the submitted jobs.
array() { sed -n 's/^submitted: job \([0-9]*\) .*/\1/p' "$work/out"; }
collector() { sed -n 's/^submitted: .* job \([0-9]*\) collects their results.*/\1/p' "$work/out"; }
# until_true SECONDS COMMAND…: fails if the command does not succeed within SECONDS.
until_true() {
  local tenths
  for ((tenths = 0; tenths < 10 * $1; ++tenths)); do
    ! "${@:2}" || return 0
    sleep 0.1
  done
  fail "not within $1 s: ${*:2}; in the queue: $(squeue 2>&1)"
}
is_queue_empty() { [[ -z "$(squeue --noheader)" ]]; }
until_queue_is_empty() { until_true 120 is_queue_empty; }
until_told() { until_true 10 grep -q -- "$1" "$work/out"; }
same() {
  diff -r -x rows -x slurm -x manifest.json -x 'times.*' "$work/whole" "$work/$1" ||
    fail "$1 differs from a run without Slurm"
}
row_files() { find "$work/$1/rows" -type f | wc -l; }
