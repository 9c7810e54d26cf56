#!/usr/bin/env bash
# in_slurm.sh [--nodes N] COMMAND [ARGS…]: runs COMMAND on the head of its own Slurm cluster. The cluster
# has N nodes (default 1) of two cores, node1, node2, …, each with its own hostname, network card, processes
# and spool folder, and a common file system. The cluster's network is separate, and its processes end with
# the script. Exit code 77: this system does not permit this.
#   kill -9 "$(cat "$IN_SLURM/node2.pid")"   power failure of a node: all its processes end
#   ip link set node2 down                   its cable is unplugged: its processes continue
set -euo pipefail

# Starts munged for a node or for the head; $own is its private folder.
start_munge() {
  own=$IN_SLURM/own
  mount -t tmpfs none "$own"
  chmod 755 "$own"
  mkdir "$own/spool"
  cp -p "$IN_SLURM/munge.key" "$own"
  # Each node needs its own munged: a shared one would refuse a message to several nodes as a replay.
  munged --force --socket="$own/munge.socket" --key-file="$own/munge.key" \
    --pid-file="$own/munge.pid" --log-file="$own/munge.log" --seed-file="$own/munge.seed"
}

# be_node K: runs within the namespaces of node K until it is killed.
be_node() {
  hostname "node$1"
  until ip link show eth0 > /dev/null 2>&1; do sleep 0.05; done
  ip link set lo up
  ip address add "10.0.0.$1/24" dev eth0
  ip link set eth0 up
  start_munge
  exec slurmd -D
}

# has_entered PID: true if the process is already in a separate network.
has_entered() {
  [[ "$(readlink "/proc/$1/ns/net")" != "$(readlink /proc/self/ns/net)" ]]
}

all_idle() {
  [[ "$(sinfo --noheader --Node --format=%T 2> /dev/null | sort | uniq -c | xargs)" == "$1 idle" ]]
}

case "${1:-}" in
  --node) be_node "$2" ;;
  --inside) shift ;;
  *)
    export PATH="$PATH:/usr/sbin"
    for program in slurmctld slurmd sbatch squeue scancel munged; do
      command -v $program > /dev/null || {
        echo "skipped: no $program (tools/setup --cluster)"
        exit 77
      }
    done
    # Without -r, because slurmd must be able to drop groups.
    if ! unshare -nmupf --mount-proc true 2> /dev/null; then
      echo "skipped: this user may not 'unshare -nmupf --mount-proc' (root may)"
      exit 77
    fi
    exec unshare -nmupf --kill-child --mount-proc "$0" --inside "$@"
    ;;
esac

nodes=1
if [[ "$1" == --nodes ]]; then
  nodes=$2
  shift 2
fi
IN_SLURM=$(mktemp -d)
export IN_SLURM SLURM_CONF=$IN_SLURM/slurm.conf
# Ends the nodes first, since they write into the folder.
leave() {
  exec 2> /dev/null  # hides the shell's message for each killed process
  jobs -p | xargs -r kill -9 || true
  wait
  umount --lazy "$IN_SLURM/own" || true
  rm -rf "$IN_SLURM"
}
trap leave EXIT
chmod 755 "$IN_SLURM"
mkdir "$IN_SLURM/own" "$IN_SLURM/state"
dd if=/dev/urandom of="$IN_SLURM/munge.key" bs=1024 count=1 status=none
chmod 400 "$IN_SLURM/munge.key"

# A node counts as down after SlurmdTimeout without contact. cred_expire: a requeued job cannot start
# earlier. JobRequeue=0: only jobs that request it are requeued.
{
  cat << END
ClusterName=alone
SlurmctldHost=head(10.0.0.254)
AuthType=auth/munge
AuthInfo=socket=$IN_SLURM/own/munge.socket,cred_expire=5
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$IN_SLURM/state
SlurmdSpoolDir=$IN_SLURM/own/spool
SlurmctldPidFile=$IN_SLURM/own/slurmctld.pid
SlurmdPidFile=$IN_SLURM/own/slurmd.pid
SlurmctldLogFile=$IN_SLURM/slurmctld.log
SlurmdLogFile=$IN_SLURM/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MaxArraySize=5
ReturnToService=2
JobRequeue=0
SlurmdTimeout=6
TCPTimeout=2
MessageTimeout=5
SchedulerParameters=sched_min_interval=0,bf_interval=1
PartitionName=all Nodes=node[1-$nodes] Default=YES State=UP
END
  for ((k = 1; k <= nodes; ++k)); do
    echo "NodeName=node$k NodeAddr=10.0.0.$k CPUs=2 State=UNKNOWN"
  done
} > "$SLURM_CONF"

hostname head
ip link set lo up
ip link add head type bridge
ip address add 10.0.0.254/24 dev head
ip link set head up
start_munge
slurmctld
for ((k = 1; k <= nodes; ++k)); do
  unshare -nmupf --kill-child --mount-proc "$0" --node "$k" > "$IN_SLURM/node$k.log" 2>&1 &
  pid=$!
  until has_entered "$pid"; do sleep 0.05; done
  ip link add "node$k" type veth peer name eth0 netns "$pid"
  ip link set "node$k" master head up
  echo "$pid" > "$IN_SLURM/node$k.pid"
done
for ((tenths = 0; tenths < 600; ++tenths)); do
  ! all_idle "$nodes" || break
  sleep 0.1
done
if ! all_idle "$nodes"; then
  echo "in_slurm.sh: not all nodes become idle:"
  sinfo --Node || true
  tail -n 20 "$IN_SLURM"/*.log
  exit 1
fi
code=0
"$@" || code=$?
if ((code != 0)); then
  tail -n 15 "$IN_SLURM"/slurm*.log
fi
exit $code
