#!/usr/bin/env bash
# slurm.sh VANTAGE, within in_slurm.sh: tests a sweep as an array of jobs: complete, detached,
# cancelled, continued and refused.
source "$(dirname "$0")/slurm_support.sh"
extent=(--smoke)

run 0 whole

# With waiting: each shard runs once, and the output has the same bytes as one complete run.
run 0 waited --slurm --shards 3
says "^submitted: job [0-9]* for shards 1-3 of 3, "
[[ $(row_files waited) == 3 ]] || fail "$(row_files waited) processes wrote rows"
same waited

# All units are finished: a repeated command submits nothing.
run 0 waited --slurm --shards 3
[[ -z "$(array)" && -z "$(squeue --noheader)" ]] || fail "finished units were submitted"
same waited

# Without waiting: the cluster collects the results.
run 0 alone --slurm --shards 2 --no-wait
says "still in the queue; results will be in "
until_queue_is_empty
[[ $(row_files alone) == 2 ]] || fail "$(row_files alone) processes wrote rows"
same alone

# While jobs are in the queue, the command names them and submits none again. Ctrl-C ends only the
# waiting.
run 0 held --slurm --shards 3 --no-wait --sbatch=--hold
array=$(array) collector=$(collector)
run 0 held --slurm --no-wait
says "^jobs $array and $collector are in the queue: nothing is submitted"
begin held --slurm
until_told "nothing is submitted"
kill -INT "$pid"
ended 1
says "To cancel: scancel $array $collector"
[[ $(squeue --noheader --array | wc -l) == 4 ]] || fail "Ctrl-C cancelled jobs: $(squeue --array)"

# One task is cancelled, and the others run. The missing task is reported, and only its shard is submitted
# again.
scancel "${array}_2"
scontrol release "$array" "$collector"
run 1 held --slurm
says "^shard 2 is incomplete: .*it did not start"
[[ $(grep -c "^shard .* is incomplete" "$work/out") == 1 ]] || fail "other shards are named"
says "^run the same command to submit the missing shards"
until_queue_is_empty
run 0 held --slurm --shards 3
says "^submitted: job [0-9]* for shards 2 of 3, "
[[ $(row_files held) == 3 ]] || fail "$(row_files held) processes wrote rows"
same held

# A shard fails because its directory belongs to another run. The failure is reported with the shard's last
# output.
run 0 broken --slurm --shards 2 --no-wait --sbatch=--hold
array=$(array) collector=$(collector)
cp "$work/broken/manifest.json" "$work/kept"
begin broken --slurm
until_told "nothing is submitted"
sed -i 's/"seed": 1/"seed": 7/' "$work/broken/manifest.json"
scontrol release "$array" "$collector"
ended 1
says "^shard 1 is incomplete: FAILED; .*/shard_1.log ends with: .*different seed"
mv "$work/kept" "$work/broken/manifest.json"
run 0 broken --slurm --shards 2
same broken

# A request that Slurm refuses is reported with Slurm's own message; no job remains in the queue.
run 2 refused --slurm --shards 2 --sbatch=--partition=none
says "Slurm rejected the job: .*invalid partition specified: none"
run 2 refused --slurm --shards 6  # in_slurm.sh allows numbers up to 4
says "Slurm rejected the job: .*[Ii]nvalid job array"
[[ -z "$(squeue --noheader)" ]] || fail "a job was submitted"

# If Slurm accepts the array but refuses the collecting job, the refusal is reported and no job
# remains. Nothing is submitted if the queue cannot be queried.
mkdir "$work/bin"
PATH="$work/bin:$PATH"
# make_fail PROGRAM CASE WORDS: makes PROGRAM fail if CASE is among its arguments.
make_fail() {
  printf '#!/bin/sh\ncase "$*" in *%s*) echo "%s" >&2; exit 1;; esac\nexec %s "$@"\n' \
    "$2" "$3" "$(command -v "$1")" > "$work/bin/$1.new"
  chmod +x "$work/bin/$1.new"
  mv "$work/bin/$1.new" "$work/bin/$1"
}
make_fail sbatch --dependency 'sbatch: error: full'
run 2 refused --slurm --shards 2 --sbatch=--hold
says "rejected the job: sbatch: error: full (job that collects the results; job [0-9]* is cancelled)"
until_queue_is_empty
rm "$work/bin/sbatch"
hash -r
make_fail squeue --states=all 'squeue: error: no controller'
run 2 refused --slurm --shards 2
says "cannot be queried: squeue: error: no controller; nothing is submitted"
echo "slurm.sh: all good"
