#!/usr/bin/env bash
# Two nodes of Ray on this machine make a dataset by `python -m convoy.ray`. A first run is interrupted, a
# second one loses a node in mid-run; another dataset loses a node whose cable is cut, so that it works on. Both
# have the bytes of one machine.
# Usage: tests/ray.sh FOLDER_OF_PROGRAMS
# Needs Ray, numpy and pyarrow (pip install ray numpy pyarrow) for the python3 that CONVOY_PYTHON names.
set -euo pipefail
bin=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
source "$here/cluster.sh"
source "$here/network.sh"
tests=$here
python=${CONVOY_PYTHON:-python3}
"$python" -c 'import ray, numpy, pyarrow' 2>/dev/null || { echo "note: skipped, $python has no Ray"; exit 0; }
[[ $(uname) == Linux ]] || { echo "note: skipped, other addresses than 127.0.0.1 are this machine on Linux alone"; exit 0; }
work=$(mktemp -d)
mkdir "$work/log"
# Nobody's configuration, and the variables of another engine, which no task may follow.
unset RAY_ADDRESS CONVOY_PROGRAM
export RAY_USAGE_STATS_ENABLED=0 PYTHONPATH=$tests/../python/src PYTHONDONTWRITEBYTECODE=1 SLURM_ARRAY_TASK_ID=99
# A node that is not heard of for half a minute counts as lost.
export RAY_health_check_period_ms=2000 RAY_health_check_timeout_ms=4000 RAY_health_check_failure_threshold=5
has_cable=1
lay_cable convoy-r 10.213.9 || {
    echo "note: no cable is cut, there are no network namespaces here"
    # Ray makes an outer address of 127.0.0.1, and leaves other ones as they are.
    has_cable= here=127.0.0.2 there=127.0.0.3
    over_there() { "$@"; }
}
free_port() { "$python" -c 'import socket, sys; s = socket.socket(); s.bind((sys.argv[1], 0)); print(s.getsockname()[1])' "$here"; }
head=$here:$(free_port)

# A process and all that it started.
tree() {
    local child
    for child in $(pgrep -P "$1"); do tree "$child"; done
    echo "$1"
}
# All that Ray started here: its helpers outlive a node, and `ray stop` would end every Ray of this machine.
of_ray() {
    local process
    for process in $(pgrep -f -- "$work/ray/|--address=$head"); do tree "$process"; done
}
stop() {
    local left
    for _ in 1 2 3; do
        left=$(of_ray)
        [[ -n $left ]] || break
        # shellcheck disable=SC2086
        kill -9 $left 2>/dev/null || true
        sleep 1
    done
    remove_cable
    [[ -n ${KEEP:-} ]] || rm -rf "$work"
}
trap stop EXIT

start() {
    "${on[@]}" "$python" -m ray.scripts.scripts start --num-cpus=1 --object-store-memory=100000000 "$@" >>"$work/log/ray" 2>&1 \
        || { cat "$work/log/ray"; echo "error: Ray does not start"; exit 1; }
}
on=()
# Its server for clients, where it is installed, has a port that others may use.
client=()
"$python" -c 'import grpc' 2>/dev/null && client=(--ray-client-server-port="$(free_port)")
start --head --node-ip-address="${head%:*}" --port="${head#*:}" "${client[@]}" \
    --include-dashboard=false --temp-dir="$work/ray"
start_other() { on=(over_there) && start --address="$head" --node-ip-address="$there"; }
start_other
configure
make_dataset() {
    exec "$python" -m convoy.ray --address "$head" --store "$work/store" --program "$bin/convoy" --logs "$work/log/tasks" "$@"
}

# Whoever is interrupted lets the tasks end at a frame.
make_dataset --config "$work/set.toml" --tasks 6 >"$work/log/first" 2>&1 &
driver=$!
wait_for_scenes 2 "$driver" || { cat "$work/log/first"; exit 1; }
kill -TERM "$driver"
code=0
wait "$driver" || code=$?
cat "$work/log/first"
[[ $code == 75 ]] || { echo "error: an interrupted run ended with $code"; exit 1; }
! pgrep -f "$bin/.*$work/store" || { echo "error: there are tasks of a run that ended"; exit 1; }
told=$(told)
echo "after the interrupt status tells $told states that are done"

# Some scenes more, then a node goes: its daemon, and all that it started.
before=$(finished)
make_dataset --config "$work/set.toml" --tasks 6 >"$work/log/second" 2>&1 &
driver=$!
wait_for_scenes $((before + 3)) "$driver" || { cat "$work/log/second"; exit 1; }
lost=$(pgrep -f "$work/ray/.*--node_ip_address=$there")
# The daemon goes first, and tells nobody of the end of its tasks.
lost=$(for process in $lost; do tree "$process"; done | tac)
# shellcheck disable=SC2086
kill -9 $lost 2>/dev/null || true
told=$(told)
echo "after the loss status tells $told states that are done"
ends_well() {
    local code=0
    wait "$driver" || code=$?
    [[ $code == 0 ]] || { cat "$1"; echo "error: the run ended with $code"; exit 1; }
    grep -v state-dump "$1"
    grep -q "again in" "$1" || { echo "error: no task was lost"; exit 1; }
}
ends_well "$work/log/second"

# All is there: nothing is made.
(make_dataset) | tail -n 1
compare

# A node works on, and nobody hears of it.
[[ -n $has_cable ]] || exit 0
rm -rf "$work/store"
start_other
make_dataset --config "$work/set.toml" --tasks 6 >"$work/log/third" 2>&1 &
driver=$!
wait_for_scenes $((scenes / 3)) "$driver" || { cat "$work/log/third"; exit 1; }
cut_cable
told=$(told)
echo "cut off with $told states that are done"
ends_well "$work/log/third"
mend_cable
for _ in $(seq 120); do pgrep -f "$bin/.*$work/store" >/dev/null || break; sleep 1; done
compare
