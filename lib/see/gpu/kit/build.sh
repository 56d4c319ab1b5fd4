#!/usr/bin/env bash
# Makes a folder, and a packed one beside it, that tries a GPU on a machine that has nothing but its driver: programs,
# two stores with a logged scene, and a script. `make gpu-kit`; docs/gpu.md says how it is used.
set -euo pipefail
kit=$(realpath -m "${1:-gpu-kit}")
here=$(realpath "$(dirname "$0")")
cd "$here/../../../.."

made() { "$@" --message-format=json | sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' | tail -n 1; }
cargo build --release --locked -p spawn-planner -p simulate-and-log -p render-sensors
tests=$(made cargo test --release --locked -p convoy-gpu --test gpu --no-run)
bench=$(made cargo bench --locked -p convoy-tests --bench agent_frame --no-run)
bin=$(realpath "${CARGO_TARGET_DIR:-target}/release")

rm -rf "$kit" "$kit.tar.xz"
mkdir -p "$kit/lib"
strip -o "$kit/render-sensors" "$bin/render-sensors"
strip -o "$kit/gpu-tests" "$tests"
strip -o "$kit/agent-frame" "$bench"
cp "$here/run.sh" "$kit/run.sh"
loader=$(ldconfig -p | sed -n 's/.*libvulkan\.so\.1 .*=> //p' | head -n 1)
[[ -n $loader ]] || { echo "error: there is no libvulkan.so.1 (Debian: libvulkan1)"; exit 2; }
cp -L "$loader" "$kit/lib/libvulkan.so.1"

for size in full small; do
    cp "$here/$size.toml" "$kit/$size.toml"
    for stage in spawn-planner simulate-and-log; do
        "$bin/$stage" --config "$kit/$size.toml" --store "$kit/store-$size" --progress none
    done
done
tar -C "$(dirname "$kit")" -cJf "$kit.tar.xz" "$(basename "$kit")"
du -sh "$kit" "$kit.tar.xz"
