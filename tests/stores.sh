#!/usr/bin/env bash
# A dataset in a bucket has the bytes of the disk's: on each server that is installed, killed on the way, with
# damage that `convoy verify` must name. Usage: tests/stores.sh FOLDER_OF_PROGRAMS [SERVER...]
# Servers: `s3s-fs` (cargo install s3s-fs --version 0.14.1 --features binary), `moto_server`
# (pip install 'moto[server]'), `azurite-blob` (npm install azurite). CONFIG and KILLS change what is run.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "$1")
shift
servers=("${@:-s3s-fs moto_server azurite-blob}")
read -ra servers <<<"${servers[*]}"
config=${CONFIG:-configs/demo.toml}
kills=${KILLS:-50}
work=$(mktemp -d)
pids=()
stop() {
    [[ ${#pids[@]} == 0 ]] || kill "${pids[@]}" 2>/dev/null || true
    wait 2>/dev/null || true
    [[ -n ${KEEP:-} ]] || rm -rf "$work"
}
trap stop EXIT
export AWS_ACCESS_KEY_ID=test AWS_SECRET_ACCESS_KEY=testsecret AWS_REGION=us-east-1 CONVOY_DEVICE=cpu
# Azurite's one account, which is published with it.
export AZURE_STORAGE_USE_EMULATOR=true

convoy() { "$bin/convoy" "$@"; }
now() { date +%s.%N; }
since() { python3 -c "import sys; print(f'{float(sys.argv[2]) - float(sys.argv[1]):.1f} s')" "$1" "$(now)"; }
made() { convoy run --config "$config" --store "$1" --progress none >>"$work/log.txt" 2>&1; }
listens() {
    for _ in $(seq 100); do
        (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null && return
        sleep 0.2
    done
    echo "error: nothing listens on port $1"
    exit 1
}

start=$(now)
made "$work/disk"
echo "on disk: $(since "$start")"

# Starts a server with an empty bucket; sets the URL of a store in it, and `plain` where its objects are files.
serve() {
    plain=
    case $1 in
    s3s-fs)
        mkdir -p "$work/s3/sets"
        plain=$work/s3/sets/one
        s3s-fs --host 127.0.0.1 --port 18014 --access-key test --secret-key testsecret "$work/s3" \
            >"$work/s3s.log" 2>&1 &
        pids+=($!)
        export AWS_ENDPOINT_URL=http://127.0.0.1:18014
        listens 18014
        url=s3://sets/one
        ;;
    moto_server)
        moto_server -H 127.0.0.1 -p 18015 >"$work/moto.log" 2>&1 &
        pids+=($!)
        export AWS_ENDPOINT_URL=http://127.0.0.1:18015
        listens 18015
        curl -fsS -X PUT "$AWS_ENDPOINT_URL/sets" >/dev/null
        url=s3://sets/one
        ;;
    azurite-blob)
        azurite-blob --silent --skipApiVersionCheck --location "$work/azurite" >"$work/azurite.log" 2>&1 &
        pids+=($!)
        listens 10000
        python3 tests/azurite_container.py sets
        url=az://sets/one
        ;;
    esac
}

# The store of the disk and that of a bucket, object by object.
same() {
    if [[ -n $plain ]]; then
        # s3s-fs leaves folders in which nothing is any more.
        find "$plain" -depth -type d -empty -delete
        diff -r "$work/disk" "$plain"
    else
        rm -rf "$work/copy"
        convoy merge --store "$work/copy" "$1" >>"$work/log.txt"
        convoy run --config "$config" --store "$work/copy" --progress none >>"$work/log.txt" 2>&1
        diff -r "$work/disk" "$work/copy"
    fi
}

for server in "${servers[@]}"; do
    command -v "$server" >/dev/null || { echo "note: skipped $server, it is not installed"; continue; }
    serve "$server"
    start=$(now)
    made "$url"
    echo "$server: $(since "$start")"
    convoy verify --store "$url" | tail -n 1
    same "$url"
    echo "$server: the bytes of the disk"

    killed=0
    round=0
    RANDOM=7
    one=$url one_plain=$plain
    while [[ $killed -lt $kills ]]; do
        # A store that is finished leaves nothing to be killed: the next one.
        round=$((round + 1))
        url=${one%/one}/killed-$round
        [[ -z $one_plain ]] || plain=${one_plain%/one}/killed-$round
        while [[ $killed -lt $kills ]]; do
            code=0
            # Now and then late enough that sensors are being written. The shell's own word on it goes nowhere.
            (timeout -s KILL "$((RANDOM % 15)).$((1 + RANDOM % 9))" "$bin/convoy" run --config "$config" --store "$url" \
                --progress none >>"$work/log.txt" 2>&1) 2>/dev/null || code=$?
            [[ $code == 137 ]] || { [[ $code == 0 ]] && break; tail -n 5 "$work/log.txt"; exit 1; }
            # Stages outlive the program that started them, if nobody ends them.
            pkill -9 -f -- "--store $url" || true
            killed=$((killed + 1))
        done
        made "$url"
        same "$url"
        convoy verify --store "$url" | tail -n 1
        [[ -z $plain || $killed -ge $kills ]] || rm -rf "$plain"
    done
    echo "$server: killed $killed times in $round stores, the bytes of the disk"

    if [[ -n $plain ]]; then
        python3 tests/plant_faults.py "$plain" 60 >"$work/planted.txt"
        convoy verify --store "$url" >"$work/findings.txt" && { echo "error: verify found nothing"; exit 1; }
        missed=0
        while read -r key; do
            grep -qF "$key" "$work/findings.txt" || { echo "error: not named: $key"; missed=$((missed + 1)); }
        done <"$work/planted.txt"
        [[ $missed == 0 ]] || exit 1
        echo "$server: verify names each of $(wc -l <"$work/planted.txt") planted faults"
    fi
done
