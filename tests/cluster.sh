# What the tests of engines share (tests/slurm.sh, tests/ray.sh): a small dataset in "$work", made by the
# programs in "$bin". To be sourced.
scenes=24

# Writes the configuration.
configure() {
    cat >"$work/set.toml" <<TOML
name = "cluster"
seed = 5
[scenes.train]
"convoy/demo" = $scenes
[agents]
min_vehicles = 1
max_vehicles = 2
min_rsus = 0
max_rsus = 1
[timing]
warmup_s = 1
min_duration_s = 1
max_duration_s = 2
[traffic]
vehicles = 20
[walkers]
count = 10
[vehicle.camera]
width = 160
height = 90
[rsu.camera]
width = 160
height = 90
[vehicle.occupancy]
voxel_m = 0.8
[rsu.occupancy]
voxel_m = 0.8
TOML
}

# How many states are done.
count() { "$bin/convoy" status --json --store "$work/store" | grep -c '"state": "done"' || true; }

# How many manifests there are.
recorded() {
    find "$work/store" \( -path '*/scenes/*/_manifests/*.json' -o -path "$work/store/plan/_manifest.json" \
        -o -path "$work/store/stats/_manifest.json" \) ! -name '*.redo.json' ! -name '*.failed.json' ! -path '*.parts/*' | wc -l
}

# What status says is done, which is what was when it was asked or has been since.
told() {
    local least told
    least=$(recorded)
    told=$(count)
    [[ $least -le $told && $told -le $(recorded) ]] || {
        echo "error: status tells $told states that are done, where $least manifests were and $(recorded) are" >&2
        return 1
    }
    echo "$told"
}

# How many scenes are finished.
finished() { find "$work/store/scenes" -name merge-tracks.json 2>/dev/null | wc -l; }

# Waits until so many scenes are finished: by a process, if one is named, that has not ended before.
wait_for_scenes() {
    for _ in $(seq 900); do
        [[ $(finished) -ge $1 ]] && return
        [[ -z ${2:-} ]] || kill -0 "$2" 2>/dev/null || { echo "error: it ended before there were $1 scenes"; return 1; }
        sleep 1
    done
    echo "error: there are no $1 scenes after a quarter of an hour"
    return 1
}

# Holds the dataset against one that this machine makes alone.
compare() {
    "$bin/convoy" status --store "$work/store" >"$work/status"
    "$bin/convoy" verify --store "$work/store"
    "$bin/convoy" run --config "$work/set.toml" --store "$work/alone" --progress none >"$work/log/alone.txt" 2>&1
    diff -r "$work/store" "$work/alone"
    echo "the dataset of two nodes, one of which was lost, has the bytes of one machine"
}
