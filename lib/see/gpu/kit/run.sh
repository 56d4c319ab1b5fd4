#!/usr/bin/env bash
# Tries a GPU: ./run.sh [DEVICE] [full|small]. DEVICE is what `--device` takes (default: gpu); `small` is for
# adapters in software, which would need hours for the full size. Ends with a table, and with 0 if all is equal.
set -uo pipefail
cd "$(dirname "$0")"
device=${1:-gpu} size=${2:-full}
export LD_LIBRARY_PATH=$PWD/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} RUST_LOG=info
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
rows=() failed=0
row() { rows+=("| $1 | $2 |"); echo "$1: $2"; }
fail() { failed=1; row "$1" "**$2**"; }
now() { date +%s.%N; }
since() { awk -v from="$1" -v to="$(now)" 'BEGIN { printf "%.2f s", to - from }'; }

echo "Adapters:"
./render-sensors --device list
row "processor" "$(nproc) threads, $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)"

from=$(now)
if ! ./render-sensors --try-device --device "$device"; then
    echo "error: --device $device cannot be used"
    exit 2
fi
row "opened, with the self-test" "$(since "$from")"

from=$(now)
if CONVOY_REQUIRE=vulkan ./gpu-tests > "$work/tests" 2>&1; then
    row "equality tests" "$(sed -n 's/^test result: ok. \([0-9]* passed\).*/\1/p' "$work/tests"), $(since "$from")"
else
    tail -n 40 "$work/tests"
    fail "equality tests" "failed"
fi

if [[ $size == full ]]; then
    for on in "$device" cpu; do
        if ! CONVOY_DEVICE=$on ./agent-frame --bench > "$work/bench" 2>&1; then
            tail -n 20 "$work/bench"
            fail "agent-frame by $on" "failed"
        fi
        echo "Agent-frame by $on:"
        cat "$work/bench"
        while IFS='|' read -r _ part seconds processor _; do
            row "$on:$part" "$seconds s, processor $processor s"
        done < <(grep -E '^\| (camera visibility|shading, 6|lidar|\*\*agent-frame)' "$work/bench")
        while IFS='|' read -r _ part calls kernels there back _; do
            row "$on, by its own clock:$part" "$kernels ms in$calls calls, MiB there $there, back $back"
        done < <(sed -n '/by its own clock/,/^$/p' "$work/bench" | grep -E '^\| (visibility|shading|lidar)')
    done
else
    row "agent-frame" "not measured in software"
fi

# Names of devices may have blanks.
file() { [[ $1 == cpu ]] && echo "$work/digests-cpu" || echo "$work/digests-device"; }
digests() { (cd "$work/store" && find scenes -path '*/sensors/*' -type f | LC_ALL=C sort | xargs sha256sum); }
for on in "$device" cpu; do
    rm -rf "$work/store" && cp -r "store-$size" "$work/store"
    from=$(now)
    if ! ./render-sensors --config "$size.toml" --store "$work/store" --device "$on" --progress none \
        > "$work/scene" 2>&1; then
        tail -n 20 "$work/scene"
        fail "scene by $on" "failed"
    fi
    row "a scene's sensors by $on (40 agent-frames, $size)" "$(since "$from")"
    grep -h 'rays by the GPU' "$work/scene"
    digests > "$(file "$on")"
    if [[ $on != cpu ]] && ! grep -q 'rays by the GPU, 0 and 0 by the CPU;' "$work/scene"; then
        fail "who saw the scene" "the CPU saw a part of it"
    fi
done
if [[ -s $work/digests-cpu ]] && cmp -s "$work/digests-device" "$work/digests-cpu"; then
    row "shards of the scene" "$(wc -l < "$work/digests-cpu"), the same bytes by both"
else
    diff "$work/digests-device" "$work/digests-cpu" | head -n 10
    fail "shards of the scene" "not the same bytes"
fi

printf '\n| what | |\n|---|---|\n'
printf '%s\n' "${rows[@]}"
exit "$failed"
