#!/usr/bin/env bash
# slurm_nodes.sh VANTAGE, within in_slurm.sh --nodes 3: tests a sweep with shards on three nodes,
# while a node is cut off, the controller is killed, or a node dies.
source "$(dirname "$0")/slurm_support.sh"
extent=(--trials 20 --jobs 2)  # two cores each, so a shard occupies a node

# unit_files DIRECTORY [PREFIX]: prints the files that nodes wrote; their names are SHARD_OF-NODE-….
unit_files() { find "$work/$1/rows" -name "${2:-}*.jsonl" 2> /dev/null; }
# units DIRECTORY [PREFIX]: prints a sorted line for each unit that was run.
units() { unit_files "$@" | xargs -r sed -n 's/^\({"setting":.*\),"rows":.*/\1/p' | sort; }
have_begun() {  # have_begun DIRECTORY NODE…: true if each node has finished some units
  local node
  for node in "${@:2}"; do
    (($(units "$1" "*-$node-" | wc -l) > 1)) || return 1
  done
}
# shard_on DIRECTORY NODE: prints the shard that NODE runs, such as "2_3".
shard_on() { basename "$(unit_files "$1" "*-$2-")" | sed 's/-.*//'; }
# is_gone_on_with DIRECTORY SHARD: true if another process continues the shard.
is_gone_on_with() { (($(unit_files "$1" "$2-" | wc -l) == 2)); }
# shared DIRECTORY SHARD: expects that each process of the shard has finished some of its units.
shared() {
  local file
  for file in $(unit_files "$1" "$2-"); do
    grep -q '^{"setting":.*}$' "$file" || fail "$1: $file has no unit: the node did not die in the middle of its shard"
  done
}
# each_once DIRECTORY: expects that all units exist, that none was run twice, and that the collecting job
# has run none.
each_once() {
  [[ "$(units "$1")" == "$(units whole)" ]] || fail "$1: a unit is missing or was run twice"
  [[ -z "$(unit_files "$1" 1_1-)" ]] || fail "$1: the collecting job has run units"
}
on_node() {  # on_node NODE SIGNAL: sends SIGNAL to the experiment on NODE
  local process network
  network=$(readlink "/proc/$(cat "$IN_SLURM/$1.pid")/ns/net")
  for process in $(pgrep -f -- "experiment heterogeneous .* --shard"); do
    [[ "$(readlink "/proc/$process/ns/net")" != "$network" ]] || kill "-$2" "$process"
  done
}
# dies DIRECTORY NODE: emulates a power failure of NODE while NODE writes a line; sets $shard to the shard
# that NODE ran.
dies() {
  kill -9 "$(cat "$IN_SLURM/$2.pid")"
  shard=$(shard_on "$1" "$2")
  printf '{"setting":"' >> "$(unit_files "$1" "$shard-$2-")"
}
all_idle() { (($(sinfo --noheader --Node --format=%T | grep -c '^idle$') == $1)); }

run 0 whole

# A node is cut off: another node gets its shard, and both run it at the same time. The shard counts once.
begin cut --slurm --shards 3
until_true 60 have_begun cut node1 node2 node3
on_node node2 STOP
ip link set node2 down
shard=$(shard_on cut node2)
until_true 120 is_gone_on_with cut "$shard"
on_node node2 CONT
ended 0
same cut
[[ "$(units cut | uniq)" == "$(units whole)" ]] || fail "units are missing"
[[ -n "$(units cut | uniq -d)" ]] || fail "no unit was run by both jobs: the test is void"
ip link set node2 up
until_true 120 all_idle 3
run 0 cut --slurm --shards 3
[[ -z "$(array)" ]] || fail "finished units were submitted"
same cut
echo "cut off: good"

# The controller is killed and restarted; the cluster still collects the results.
run 0 controller --slurm --shards 3 --no-wait
until_true 60 have_begun controller node1 node2 node3
for node in node1 node2 node3; do on_node $node STOP; done
touch "$work/before"
scontrol update job="$(array)" comment=changed  # the controller saves its changes some seconds later
is_kept() { [[ "$IN_SLURM/state/job_state" -nt "$work/before" ]]; }
until_true 60 is_kept
kill -9 "$(cat "$IN_SLURM/own/slurmctld.pid")"
for node in node1 node2 node3; do on_node $node CONT; done
sleep 1
slurmctld
until_true 120 all_idle 3
until_queue_is_empty
each_once controller
same controller
echo "controller killed: good"

# A node dies: another node continues its shard, which is collected at the end.
run 0 dies --slurm --shards 3 --no-wait
until_true 60 have_begun dies node1 node2 node3
dies dies node2
until_true 120 is_gone_on_with dies "$shard"
until_queue_is_empty
each_once dies
shared dies "$shard"
same dies
echo "node dies: good"

# If the user forbids requeueing, the loss is reported, and the next command runs only the missing part.
run 0 lost --slurm --shards 2 --no-wait --sbatch=--no-requeue
until_true 60 have_begun lost node1 node3
dies lost node3
run 1 lost --slurm
says "^shard ${shard%_*} is incomplete: NODE_FAIL; "
[[ $(grep -c "^shard .* is incomplete" "$work/out") == 1 ]] || fail "other shards are named"
run 0 lost --slurm --shards 2
says "^submitted: job [0-9]* for shards ${shard%_*} of 2, "
each_once lost
shared lost "$shard"
same lost
echo "slurm_nodes.sh: all good"
