#!/usr/bin/env bash
# What machines do to a dataset in the making: kills at random, many processes at once, no memory, no handles, full,
# read-only and forbidden disks, long paths, containers of one name, a service that is away, a cut cable. After each the
# next run makes the bytes of a quiet machine. Usage: tests/faults.sh FOLDER_OF_PROGRAMS [PART...]
# KILLS says how many kills there are (1000), SEED which. What needs root or a package skips with a note.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "$1")
shift
parts=("${@:-kills many memory handles full read-only forbidden long containers away cable}")
read -ra parts <<<"${parts[*]}"
kills=${KILLS:-1000}
seed=${SEED:-7}
work=$(mktemp -d)
export CONVOY_DEVICE=cpu AWS_ACCESS_KEY_ID=test AWS_SECRET_ACCESS_KEY=testsecret AWS_REGION=us-east-1
cp tests/configurations/street.toml "$work/tiny.toml"
servers=()
mounted=()
source tests/network.sh
stop() {
    [[ ${#servers[@]} == 0 ]] || kill "${servers[@]}" 2>/dev/null || true
    for folder in "${mounted[@]}"; do umount "$folder" 2>/dev/null || true; done
    remove_cable
    rm -rf "$work"
}
trap stop EXIT

run() { "$bin/convoy" run --config "$work/tiny.toml" --progress none --store "$@"; }
fail() {
    echo "error: $*"
    exit 1
}
# The store is that of a quiet machine. s3s-fs leaves folders in which nothing is any more.
same() {
    find "$1" -depth -type d -empty -delete
    diff -r "$work/quiet" "$1" >"$1-diff.txt" || fail "$part: $(head -n 3 "$1-diff.txt")"
}
# A run that is disturbed ends with one of these codes (a list with `|`), and says why.
disturbed() {
    local codes=$1 code=0
    shift
    "$@" >"$work/said.txt" 2>&1 || code=$?
    [[ $code =~ ^($codes)$ ]] || fail "$part: exit $code: $(tail -n 3 "$work/said.txt")"
    [[ $code == 0 || $code == 137 || $code == 134 || $code == 127 ]] || grep -q "ERROR" "$work/said.txt" || fail "$part: exit $code without a word"
    # Without memory zstd cannot but panic; how the program ends is what counts.
    ! grep "panicked" "$work/said.txt" | grep -v "zstd-safe" >"$work/panics.txt" || fail "$part: $(head -n 1 "$work/panics.txt")"
    echo "$part: exit $code: $(grep -m 1 ERROR "$work/said.txt" | sed "s#$work/##g" | cut -c 1-150 || true)"
}
# What lies there is sound, and the next run completes it.
ends_well() {
    ! "$bin/convoy" verify --store "$1" 2>&1 | grep -E "missing|expected|changed" || fail "$part: damage"
    run "$1" >"$work/said.txt" 2>&1 || fail "$part: the next run: $(tail -n 3 "$work/said.txt")"
    same "$1"
}
root() { [[ $(id -u) == 0 ]] || { echo "note: skipped $part, it needs root"; return 1; }; }

run "$work/quiet" >/dev/null 2>&1

# Two lines of stores, since a run of the smallest dataset leaves one of two cores idle.
kills() {
    local pids=() code=0
    for line in 0 1; do
        kills_of "$line" "$(((kills + line) / 2))" &
        pids+=($!)
    done
    for pid in "${pids[@]}"; do wait "$pid" || code=$?; done
    [[ $code == 0 ]] || exit $code
}

kills_of() {
    local line=$1 wanted=$2 killed=0 stores=0 store=$work/kills-$1
    RANDOM=$((seed + line))
    while [[ $killed -lt $wanted ]]; do
        local code=0
        rm -rf "$store"
        stores=$((stores + 1))
        while true; do
            setsid "$bin/convoy" run --config "$work/tiny.toml" --progress none --store "$store" >"$store.txt" 2>&1 &
            local pid=$!
            # From at once to late enough that some end by themselves.
            sleep "$((RANDOM % 2)).$(printf %03d $((RANDOM % 1000)))" &
            wait -n $! $pid || true
            if kill -0 $pid 2>/dev/null; then
                kill -KILL -- -$pid 2>/dev/null || true
                wait $pid 2>/dev/null || true
                killed=$((killed + 1))
            else
                code=0
                wait $pid || code=$?
                break
            fi
        done
        [[ $code == 0 ]] || fail "$part: exit $code: $(tail -n 3 "$store.txt")"
        same "$store"
    done
    echo "$part: $killed of $stores stores"
}

many() {
    for number in 2 8; do
        local pids=()
        for ((i = 0; i < number; i++)); do
            run "$work/many-$number" --threads 1 >"$work/said-$i.txt" 2>&1 &
            pids+=($!)
        done
        for pid in "${pids[@]}"; do
            local code=0
            wait "$pid" || code=$?
            # Another one was ahead with the same: nothing is lost.
            [[ $code == 0 || $code == 75 ]] || fail "$part: exit $code: $(grep -h ERROR "$work"/said-*.txt | head -n 3)"
        done
        ends_well "$work/many-$number"
        echo "$part: $number at once"
    done
}

memory() {
    for mib in 30 60 120 240; do
        # 127: there is not even room for the program.
        disturbed "0|75|127|134|137" bash -c "ulimit -v $((mib * 1024)); exec '$bin/convoy' run --config '$work/tiny.toml' \
            --progress none --store '$work/memory-$mib'"
        ends_well "$work/memory-$mib"
    done
}

handles() {
    for number in 8 12 20 40; do
        disturbed "0|1|2|75" bash -c "ulimit -n $number; exec '$bin/convoy' run --config '$work/tiny.toml' \
            --progress none --store '$work/handles-$number'"
        ends_well "$work/handles-$number"
    done
}

full() {
    root || return 0
    local folder=$work/full
    mkdir "$folder"
    mount -t tmpfs -o size=64k none "$folder"
    mounted+=("$folder")
    for kib in 64 256 512 1024 2048; do
        mount -o "remount,size=${kib}k" "$folder"
        disturbed "0|75" run "$folder/store"
    done
    mount -o remount,size=64m "$folder"
    ends_well "$folder/store"
}

read-only() {
    root || return 0
    local folder=$work/read-only
    mkdir "$folder"
    mount -t tmpfs none "$folder"
    mounted+=("$folder")
    run "$folder/store" --stages plan,simulate-and-log >/dev/null 2>&1
    mount -o remount,ro "$folder"
    disturbed "2|75" run "$folder/store"
    mount -o remount,rw "$folder"
    ends_well "$folder/store"
}

forbidden() {
    root || return 0
    local store=$work/forbidden
    run "$store" --stages plan,simulate-and-log >/dev/null 2>&1
    chmod -R a-w "$store"
    chmod a+rx "$work"
    disturbed "2|75" setpriv --reuid 65534 --clear-groups "$bin/convoy" run --config "$work/tiny.toml" --progress none \
        --store "$store"
    chmod -R u+w "$store"
    ends_well "$store"
}

long() {
    local folder name
    name=$(printf 'n%.0s' $(seq 200))
    # A name that is too long by itself, and a path that is.
    disturbed 2 run "$work/$name$name"
    folder=$work
    for _ in $(seq 20); do folder=$folder/$name; done
    disturbed 2 run "$folder"
}

# Two containers that have one name and numbers of processes of their own.
containers() {
    root || return 0
    local inside="run --config $work/tiny.toml --progress none --store $work/containers --threads 1"
    for round in 1 2 3; do
        local pids=()
        rm -rf "$work/containers"
        for i in 1 2; do
            # shellcheck disable=SC2086
            unshare --pid --fork --mount-proc --uts "$bin/convoy" $inside >"$work/said-$i.txt" 2>&1 &
            pids+=($!)
        done
        for pid in "${pids[@]}"; do
            local code=0
            wait "$pid" || code=$?
            [[ $code == 0 || $code == 75 ]] || fail "$part: exit $code: $(grep -h ERROR "$work"/said-*.txt | head -n 3)"
            ! grep -h "rename into place\|sync" "$work"/said-*.txt || fail "$part: one took the other's files away"
        done
        ends_well "$work/containers"
    done
    echo "$part: two at once, three times"
}

listens() {
    for _ in $(seq 100); do
        (exec 3<>"/dev/tcp/$1/$2") 2>/dev/null && return
        sleep 0.1
    done
    fail "nothing listens on $1:$2"
}
serve() { s3s-fs --host "$1" --port "$2" --access-key test --secret-key testsecret "$work/s3" >"$work/s3.log" 2>&1 & }

away() {
    command -v s3s-fs >/dev/null || { echo "note: skipped $part, s3s-fs is not installed"; return 0; }
    mkdir -p "$work/s3/sets"
    export AWS_ENDPOINT_URL=http://127.0.0.1:18016
    serve 127.0.0.1 18016
    local server=$! pid code=0
    listens 127.0.0.1 18016
    run s3://sets/away >"$work/said.txt" 2>&1 &
    pid=$!
    for _ in 1 2 3; do
        sleep 1
        kill -KILL $server
        wait $server 2>/dev/null || true
        sleep 2
        serve 127.0.0.1 18016
        server=$!
    done
    servers+=("$server")
    wait $pid || code=$?
    [[ $code == 0 ]] || fail "$part: exit $code: $(tail -n 3 "$work/said.txt")"
    same "$work/s3/sets/away"
    echo "$part: a service that went three times for two seconds"
    # For good.
    kill -KILL $server
    wait $server 2>/dev/null || true
    CONVOY_RETRY_S=2 disturbed 75 run s3://sets/gone
}

cable() {
    root || return 0
    command -v s3s-fs >/dev/null || { echo "note: skipped $part, s3s-fs is not installed"; return 0; }
    lay_cable convoy-f 10.213.7 || { echo "note: skipped $part, no network namespaces here"; return 0; }
    mkdir -p "$work/s3/sets"
    export AWS_ENDPOINT_URL=http://$there:18017
    over_there s3s-fs --host "$there" --port 18017 --access-key test --secret-key testsecret \
        "$work/s3" >"$work/s3.log" 2>&1 &
    servers+=($!)
    listens "$there" 18017
    local pid code=0
    run s3://sets/cable >"$work/said.txt" 2>&1 &
    pid=$!
    sleep 1
    cut_cable
    sleep 5
    mend_cable
    wait $pid || code=$?
    [[ $code == 0 || $code == 75 ]] || fail "$part: exit $code: $(grep -m 3 ERROR "$work/said.txt")"
    run s3://sets/cable >"$work/said.txt" 2>&1 || fail "$part: the next run: $(tail -n 3 "$work/said.txt")"
    same "$work/s3/sets/cable"
    echo "$part: cut for five seconds, exit $code"
}

for part in "${parts[@]}"; do
    "$part"
done
