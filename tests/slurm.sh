#!/usr/bin/env bash
# Two nodes of Slurm on this machine make a dataset by the scripts of `convoy submit`; one node is killed in
# mid-run. Then another dataset, where a node's cable is cut, so that the node works on while its task is given
# to the other one. Both have the bytes of one machine. Usage: tests/slurm.sh FOLDER_OF_PROGRAMS
# Needs root and Debian's slurm-wlm and munge (apt-get install --no-install-recommends slurm-wlm munge), for the
# cable network namespaces. WAYS=cable leaves the first out. Some forty minutes beside a build, of which Slurm
# holds requeued tasks for four.
set -euo pipefail
bin=$(realpath "$1")
source "$(dirname "$0")/cluster.sh"
source "$(dirname "$0")/network.sh"
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
    remove_cable
    [[ -n ${KEEP:-} ]] || rm -rf "$work"
}
trap stop EXIT

mkdir -p "$work"/{ctld,d_n1,d_n2,log,run}
host=$(hostname -s)
read -ra ways <<<"${WAYS:-process cable}"
# Daemons that are told to listen at one address take the one that the host's name has, which is not the cable's.
listening=
lay_cable convoy-s 10.213.8 || {
    echo "note: no cable is cut, there are no network namespaces here"
    ways=(process) here=127.0.0.1 there=127.0.0.1
    listening=CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
    over_there() { "$@"; }
}
cat >"$work/slurm.conf" <<CONF
ClusterName=convoy
SlurmctldHost=$host($here)
SlurmctldPort=17000
$listening
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
NodeName=n1 NodeHostname=$host NodeAddr=$here Port=17001 CPUs=1 Sockets=1 CoresPerSocket=1 ThreadsPerCore=1 RealMemory=8192 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=$there Port=17002 CPUs=1 Sockets=1 CoresPerSocket=1 ThreadsPerCore=1 RealMemory=8192 State=UNKNOWN
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
over_there slurmd -N n2
for _ in $(seq 30); do [[ $(sinfo -h -t idle -o %D) == 2 ]] && break; sleep 1; done
sinfo

# Processes of a job, by their environment.
of_job() {
    local process
    for process in /proc/[0-9]*; do
        if { tr '\0' '\n' <"$process/environ" | grep -qx "SLURM_JOB_ID=$1"; } 2>/dev/null; then
            echo "${process#/proc/}"
        fi
    done
}
# A node's daemon is killed, and all that it started.
lose_process() {
    local node lost
    node=$(squeue -h -t R -o %N | head -1)
    lost=$(squeue -h -t R -w "$node" -o %A | head -1)
    echo "kills $node, which runs job $lost"
    # Who would tell of the job's end goes first.
    kill -9 "$(cat "$work/run/slurmd_$node.pid")"
    pkill -9 -f "slurmstepd: \\[$lost\\." || true
    # shellcheck disable=SC2046
    kill -9 $(of_job "$lost") 2>/dev/null || true
    rm -f "$work/run/slurmd_$node.pid"
}
# A node's cable is cut: it works on, and nobody hears of it.
lose_cable() {
    local lost
    # Between two tasks a node has none.
    for _ in $(seq 60); do
        lost=$(squeue -h -t R -w n2 -o %A | head -1)
        [[ -n $lost ]] && break
        sleep 1
    done
    [[ -n $lost ]] || { echo "error: n2 has nothing to do"; exit 1; }
    cut_cable
    echo "cuts off n2, which runs job $lost and works on: processes $(of_job "$lost" | tr '\n' ' ')"
    for _ in $(seq 60); do [[ $(sinfo -h -n n2 -o %T) == down* ]] && break; sleep 1; done
    sinfo -N
    [[ $(sinfo -h -n n2 -o %T) == down* ]] || { echo "error: n2 is not missed"; exit 1; }
}

configure
for way in "${ways[@]}"; do
    "$bin/convoy" submit --engine slurm --config "$work/set.toml" --store "$work/store" --tasks 6 --cores 1 --memory 2 \
        --minutes 60 --partition dev --submit | tee "$work/submitted"
    # A third of the scenes, then a node goes.
    wait_for_scenes $((scenes / 3))
    squeue
    "lose_$way"
    told=$(told)
    echo "after the loss status tells $told states that are done"
    for _ in $(seq 900); do
        [[ -z $(squeue -h -o %i) ]] && break
        sleep 1
    done
    squeue
    tail -n 3 "$work"/store-jobs/logs/join-*.log
    grep -h "again\|requeue\|waits for" "$work"/store-jobs/logs/* | head -n 5 || true
    compare
    echo "one node was lost by its $way"
    rm -rf "$work/store" "$work/store-jobs"
    [[ $way != process || ${#ways[@]} == 1 ]] || {
        # The lost one comes back.
        pgrep -f "slurmd -N n1" >/dev/null || slurmd -N n1
        pgrep -f "slurmd -N n2" >/dev/null || over_there slurmd -N n2
        for _ in $(seq 60); do [[ $(sinfo -h -t idle -o %D) == 2 ]] && break; sleep 1; done
        sinfo
    }
done
