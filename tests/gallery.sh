#!/usr/bin/env bash
# The pictures of docs/gallery: the same frames of towns in five weathers and three that change, as RGB cameras see them.
# tests/gallery.sh BIN DEST [MAPS]: built programs, a folder for the pictures, CARLA's maps (without them their rows are left out).
set -euo pipefail
bin=$1 dest=$2 maps=${3:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$dest"

clear="precipitation = 0, precipitation_deposits = 0, wetness = 0, fog_density = 0, sun_azimuth_deg = 140"
weather() {
    case $1 in
    day) echo "{ $clear, cloudiness = 25, sun_altitude_deg = 48 }" ;;
    dusk) echo "{ $clear, cloudiness = 25, sun_altitude_deg = 3 }" ;;
    night) echo "{ $clear, cloudiness = 25, sun_altitude_deg = -30 }" ;;
    rain) echo "{ cloudiness = 95, precipitation = 80, precipitation_deposits = 70, wetness = 80, fog_density = 5, \
        fog_distance_m = 20, fog_falloff = 0.5, sun_azimuth_deg = 140, sun_altitude_deg = 40 }" ;;
    fog) echo "{ cloudiness = 70, precipitation = 0, precipitation_deposits = 0, wetness = 0, fog_density = 65, \
        fog_distance_m = 5, fog_falloff = 0.5, sun_azimuth_deg = 140, sun_altitude_deg = 40 }" ;;
    cloudy) echo "{ $clear, cloudiness = 85, sun_altitude_deg = 40 }" ;;
    low) echo "{ $clear, cloudiness = 25, sun_altitude_deg = 10 }" ;;
    dark) echo "{ $clear, cloudiness = 25, sun_altitude_deg = -14 }" ;;
    esac
}

# scene MAP SEED FIRST LAST FRAMES NAME: pictures of a scene that goes from one weather to another.
scene() {
    local map=$1 seed=$2 first=$3 last=$4 frames=$5 name=$6
    local store=$work/$name config=$work/$name.toml
    cat >"$config" <<TOML
name = "gallery"
seed = $seed
scenes = { train = { "$map" = 1 } }
agents = { min_vehicles = 1, max_vehicles = 1, min_rsus = 0, max_rsus = 0 }
timing = { min_duration_s = 2, max_duration_s = 2 }
weather = { initial = $(weather "$first"), final = $(weather "$last") }
walkers = { count = 80 }
traffic = { vehicles = 80 }
bev = { enabled = false }
[vehicle]
camera = { width = 800, height = 450, instance = false, jpeg_quality = 76 }
cameras = [{ name = "CAM", xyz_m = [0.4, 0.0, 1.6], rpy_deg = [0, 0, 0] }]
lidar = { enabled = false }
radar = { enabled = false }
TOML
    local stage
    for stage in spawn-planner simulate-and-log render-sensors; do
        "$bin/$stage" --config "$config" --store "$store" ${maps:+--maps "$maps"} >/dev/null
    done
    "$bin/viz" --store "$store" --agents vehicle_0 --modes RGB-CAM --no-boxes --frames "$frames" --dest "$store/pictures" >/dev/null
    local k=0 picture
    for picture in $(find "$store/pictures" -type f | sort); do
        cp "$picture" "$dest/$name$([[ $frames == *,* ]] && echo "_$k").${picture##*.}"
        k=$((k + 1))
    done
    rm -rf "$store"
}

towns=("convoy/demo 27" "convoy/01 4" "convoy/03 5" "convoy/05 6" "convoy/08 7" "convoy/10 8")
[[ -n $maps ]] && towns+=("Town03 9" "Town10HD 10")
for town in "${towns[@]}"; do
    read -r map seed <<<"$town"
    for kind in day dusk night rain fog; do
        scene "$map" "$seed" $kind $kind 20 "${map//\//_}_$kind"
    done
done
# The page: rows of pictures that belong together.
row() {
    local picture
    for picture in "$@"; do
        [[ -f $dest/$picture.jpg ]] && printf '<img src="%s.jpg" width="%s" alt="%s"> ' "$picture" "$width" "$picture"
    done
    printf '\n\n'
}
page() {
    printf '# Gallery\n\nWritten by `make gallery`; what is simple in these pictures is said in [limits.md](../limits.md).\n'
    width=260
    for town in "${towns[@]}"; do
        read -r map _ <<<"$town"
        printf '\n## %s: day, dusk, night, rain, fog\n\n' "$map"
        row "${map//\//_}"_{day,dusk,night,rain,fog}
    done
    printf '## Weather that changes: cloudy to rainy, day to night, clear to fog\n\n'
    row change_rain_{0..3}
    row change_night_{0..3}
    row change_fog_{0..3}
    printf '## Vehicles\n\n'
    width=600
    local kinds
    kinds=$(cd "$dest" && ls | sed -n 's/^\(\(car\|van\|truck\|bus\|motorcycle\|bicycle\|train\)-.*\)\.jpg$/\1/p')
    # shellcheck disable=SC2086
    row $kinds
    printf '## People\n\n'
    kinds=$(cd "$dest" && ls | sed -n 's/^\(people-.*\)\.jpg$/\1/p')
    # shellcheck disable=SC2086
    row $kinds
}

scene convoy/08 11 cloudy rain 0,13,26,39 change_rain
scene convoy/08 12 low dark 0,13,26,39 change_night
scene convoy/08 13 day fog 0,13,26,39 change_fog
page >"$dest/README.md"
