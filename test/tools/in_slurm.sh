#!/usr/bin/env bash
# in_slurm.sh COMMAND [ARGS…]: runs COMMAND beside a Slurm of its own, one node of two cores, in
# namespaces that nothing reaches or survives outside. Exit code 77: cannot.
set -euo pipefail
if [[ "${1:-}" != --inside ]]; then
  export PATH="$PATH:/usr/sbin"
  for program in slurmctld slurmd sbatch squeue scancel munged; do
    command -v $program > /dev/null || {
      echo "skipped: no $program (tools/setup --cluster)"
      exit 77
    }
  done
  # Not -r: slurmd must be able to drop groups.
  if ! unshare -nmpf --mount-proc true 2> /dev/null; then
    echo "skipped: this user may not 'unshare -nmpf --mount-proc' (root may)"
    exit 77
  fi
  exec unshare -nmpf --kill-child --mount-proc "$0" --inside "$@"
fi
shift

# Slurm listens on no network that has but loopback addresses (AI_ADDRCONFIG).
ip link set lo up
ip address add 10.0.0.1/32 dev lo
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
chmod 755 "$dir"
host=$(hostname -s)
dd if=/dev/urandom of="$dir/munge.key" bs=1024 count=1 status=none
chmod 400 "$dir/munge.key"
munged --force --socket="$dir/munge.socket" --key-file="$dir/munge.key" \
  --pid-file="$dir/munge.pid" --log-file="$dir/munge.log" --seed-file="$dir/munge.seed"
export SLURM_CONF="$dir/slurm.conf"
cat > "$SLURM_CONF" << END
ClusterName=alone
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MaxArraySize=5
ReturnToService=2
SchedulerParameters=sched_min_interval=0,bf_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES State=UP
END
mkdir "$dir/state" "$dir/spool"
slurmctld
slurmd
for ((k = 0; k < 300; ++k)); do
  [[ "$(sinfo --noheader --format=%T 2> /dev/null)" == idle ]] && break
  sleep 0.1
done
if [[ "$(sinfo --noheader --format=%T)" != idle ]]; then
  echo "in_slurm.sh: the node does not become idle:"
  tail -n 20 "$dir"/*.log
  exit 1
fi
code=0
"$@" || code=$?
if ((code != 0)); then
  tail -n 15 "$dir"/slurm*.log
fi
exit $code
