#!/usr/bin/env bash
# Two nodes of Slurm on this machine make a dataset by the scripts of `convoy submit`; one node is killed in
# mid-run. The dataset has the bytes of one machine. Usage: tests/slurm.sh FOLDER_OF_PROGRAMS
# Needs root and Debian's slurm-wlm and munge (apt-get install --no-install-recommends slurm-wlm munge); some
# twenty minutes beside a build, of which Slurm holds a requeued task for two.
set -euo pipefail
bin=$(realpath "$1")
source "$(dirname "$0")/cluster.sh"
for tool in sbatch slurmctld slurmd munged; do
    PATH=$PATH:/usr/sbin command -v "$tool" >/dev/null || { echo "note: skipped, there is no $tool"; exit 0; }
done
[[ $(id -u) == 0 ]] || { echo "note: skipped, the daemons of Slurm are started by root alone"; exit 0; }
export PATH=$PATH:/usr/sbin
work=$(mktemp -d)
pids=()
stop() {
    # All that was started here, and nothing else.
    for file in "$work"/run/*.pid; do [[ -f $file ]] && pids+=("$(cat "$file")"); done
    [[ ${#pids[@]} == 0 ]] || kill "${pids[@]}" 2>/dev/null || true
    sleep 1
    [[ -n ${KEEP:-} ]] || rm -rf "$work"
}
trap stop EXIT

mkdir -p "$work"/{ctld,d_n1,d_n2,log,run}
host=$(hostname -s)
cat >"$work/slurm.conf" <<CONF
ClusterName=convoy
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=17000
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthType=auth/munge
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$work/ctld
SlurmdSpoolDir=$work/d_%n
SlurmctldPidFile=$work/run/slurmctld.pid
SlurmdPidFile=$work/run/slurmd_%n.pid
SlurmctldLogFile=$work/log/slurmctld.log
SlurmdLogFile=$work/log/slurmd_%n.log
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=20
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=2,bf_interval=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
KillWait=5
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1 Sockets=1 CoresPerSocket=1 ThreadsPerCore=1 RealMemory=8192 State=UNKNOWN
PartitionName=dev Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
if ! pgrep -x munged >/dev/null; then
    mkdir -p /run/munge && chown munge:munge /run/munge
    setpriv --reuid=munge --regid=munge --clear-groups munged
fi
slurmctld
for _ in $(seq 20); do sinfo -h >/dev/null 2>&1 && break; sleep 1; done
slurmd -N n1
slurmd -N n2
for _ in $(seq 30); do [[ $(sinfo -h -t idle -o %D) == 2 ]] && break; sleep 1; done
sinfo

configure
"$bin/convoy" submit --engine slurm --config "$work/set.toml" --store "$work/store" --tasks 6 --cores 1 --memory 2 \
    --minutes 60 --partition dev --submit | tee "$work/submitted"

# A third of the scenes, then a node goes: its daemon, and all that it started.
wait_for_scenes $((scenes / 3))
squeue
node=$(squeue -h -t R -o %N | head -1)
lost=$(squeue -h -t R -w "$node" -o %A | head -1)
echo "loses $node, which runs job $lost"
# Who would tell of the job's end goes first.
kill -9 "$(cat "$work/run/slurmd_$node.pid")"
pkill -9 -f "slurmstepd: \\[$lost\\." || true
# Whatever else the job had, by its environment.
for process in /proc/[0-9]*; do
    if { tr '\0' '\n' <"$process/environ" | grep -qx "SLURM_JOB_ID=$lost"; } 2>/dev/null; then
        kill -9 "${process#/proc/}" 2>/dev/null || true
    fi
done
rm -f "$work/run/slurmd_$node.pid"
told=$(count)
echo "after the loss status tells $told states that are done"

for _ in $(seq 600); do
    [[ -z $(squeue -h -o %i) ]] && break
    sleep 1
done
squeue
tail -n 3 "$work"/store-jobs/logs/join.log
compare
