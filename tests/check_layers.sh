#!/usr/bin/env bash
# Dependencies point one way: each crate may depend only on the crates named after it here, a program on the readers and
# on cores as they are listed (`convoy` has the checker and the viewer in it); and no files of a crate need one another in a circle (tests/layers).
# `bins/check` shares nothing with the programs that it checks.
set -euo pipefail
cd "$(dirname "$0")/.."

declare -A allowed=(
    [arguments]="pictures pipeline schema"
    [frames]=""
    [random]=""
    [lanes]=""
    [lettering]=""
    [textures]="lanes"
    [schema]="frames"
    [formats]=""
    [store]="schema"
    [pipeline]="closures frames schema store"
    [opendrive]="frames lettering"
    [mapview]="frames opendrive"
    [pictures]="frames mapview schema"
    [packs]="frames people schema"
    [town]="frames opendrive random"
    [surfaces]="frames opendrive schema"
    [scenery]="frames opendrive random schema surfaces"
    [tiles]="opendrive scenery schema surfaces"
    [tilestore]="opendrive schema store tiles"
    [solids]="frames schema"
    [people]="frames schema solids"
    [actors]="frames lettering people random schema solids"
    [world]="actors frames schema"
    [plan]="frames opendrive random schema"
    [traffic]="frames opendrive random schema"
    [renderer]="frames lanes schema"
    [visibility]="frames renderer schema"
    [sensors]="frames lanes random renderer schema textures"
    [annotation]="frames opendrive schema"
    [bev]="counts culling frames schema"
    [bevmap]="bev opendrive"
    [carve]="frames"
    [counts]="schema"
    [culling]="frames schema"
    [fill]="schema voxelgrid"
    [tracks]="counts frames schema"
    [validity]="frames schema"
    [closures]=""
    [driver]="pipeline schema store"
    [voxelgrid]="counts schema"
    [voxels]="culling frames renderer schema voxelgrid"
    [vectormap]="opendrive schema"
    [analysis]="frames schema"
    [thumbnail]=""
    [testkit]="frames opendrive renderer schema"
    [scene]="formats frames schema store"
    [export]="formats frames mapstore mapview scene schema store"
    [evaluation]="formats frames scene schema store"
    [import]="counts formats frames schema store"
    [forecast]="plan schema"
    [mapstore]="opendrive store"
    [modelstore]="packs store"
    [framewise]="counts formats pipeline scene schema store"
    [replay]="actors mapstore modelstore opendrive packs scene schema store world"
)
# What every program may use: it reads, calls a core and commits. Then its cores.
readers="frames pipeline scene schema store"
declare -A cores=(
    [spawn-planner]="forecast mapstore opendrive packs plan town vectormap"
    [simulate-and-log]="annotation counts mapstore modelstore opendrive people random scenery surfaces tiles tilestore traffic"
    [render-sensors]="counts framewise renderer replay sensors visibility"
    [bev-gt]="bev bevmap counts formats framewise replay"
    [occupancy-gt]="counts formats framewise renderer replay voxelgrid voxels"
    [postprocess-valid]="carve counts fill formats framewise validity voxelgrid"
    [merge-tracks]="tracks"
    [stats]="analysis thumbnail"
    [export]="arguments export-core"
    [evaluate]="analysis arguments evaluation export-core"
    [import]="arguments import-core"
    [viz]="arguments export-core mapview pictures"
    [convoy]="arguments check driver mapstore mapview opendrive town view"
)
bad=0
for manifest in lib/*/Cargo.toml bins/*/Cargo.toml; do
    folder=$(dirname "$manifest")
    crate=$(basename "$folder")
    if [[ $folder == lib/* && -v "allowed[$crate]" ]]; then
        may=${allowed[$crate]}
    elif [[ $folder == bins/check || $folder == bins/view ]]; then
        may=schema
    elif [[ $folder == bins/* && -v "cores[$crate]" ]]; then
        may="$readers ${cores[$crate]}"
    else
        echo "$manifest: crate $crate has no place in tests/check_layers.sh"
        bad=1
        continue
    fi
    # `name.workspace = true`, `name = { ... }`; tests and benchmarks may use what they like.
    used=$(awk '/^\[/{inside = /^\[(build-)?dependencies\]/} inside && /^[a-z]/{sub(/[. =].*/, ""); print}' "$manifest")
    for dependency in $used; do
        [[ -d "lib/$dependency" || -d "bins/$dependency" ]] || continue
        if [[ " $may " != *" $dependency "* ]]; then
            echo "$manifest: $crate must not depend on $dependency"
            bad=1
        fi
    done
done
# The checker finds no fault that it shares with the makers: of this workspace it knows numbers and names of `schema` alone.
checker=bins/check
names='Published|BevClass|DetectionClass|Tag|FRAME_PERIOD_S|FORMAT_VERSION|ReturnKind|SIGN_TYPES'
if grep -rnE 'schema::' "$checker/src" | grep -vE "schema::(($names)\b|\{($names)(, ($names))*\})"; then
    echo "$checker: of schema it may use $names"
    bad=1
fi
"${CARGO:-cargo}" run --quiet --locked --package convoy-layers || bad=1
exit $bad
