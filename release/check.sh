#!/usr/bin/env bash
# Tries a release where there is no Rust: `make release-check [DIST=dist] [ROOTS="folder ..."] [NATIVE=target/release/convoy]`.
# The bundle is unpacked and the wheel is installed into an environment of its own (pip fetches numpy and pyarrow); each makes the
# demo, and what both made must be the same bytes. ROOTS are folders with another system (debootstrap bullseye FOLDER), in which
# the bundle makes the demo, too; NATIVE is a program of this machine's own build, which must make the same.
set -euo pipefail
cd "$(dirname "$0")/.."
dist=$(realpath "${1:-dist}")
python=${CONVOY_PYTHON:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
die() { echo "error: $*" >&2; exit 1; }
say() { echo "== $*"; }

# What a machine has that has nothing of ours: no cargo on the PATH, none of our variables.
bare() { env -i PATH=/usr/local/bin:/usr/bin:/bin HOME="$work" CONVOY_DEVICE=cpu "$@"; }
# Digests of a store's data. Manifests name the program that made what they list.
digests() { (cd "$1" && find . -type f ! -path '*_manifest*' | LC_ALL=C sort | xargs sha256sum); }
same() {
    digests "$2" >"$work/these"
    [[ $(wc -l <"$work/these") -gt 20 ]] || die "$1: made hardly anything"
    if [[ ! -f $work/first ]]; then
        mv "$work/these" "$work/first"
    else
        diff "$work/first" "$work/these" >"$work/diff" || die "$1: other bytes than the bundle: $(head -n 5 "$work/diff")"
    fi
    echo "$1: $(wc -l <"$work/first") files, the same bytes"
}

say "sums"
(cd "$dist" && sha256sum --check --quiet SHA256SUMS)

say "bundle"
mkdir "$work/bundle"
tar -xf "$dist"/convoy-*-x86_64-linux-gnu.tar.xz -C "$work/bundle" --strip-components 1
for file in bin/render-sensors share/man/man1/convoy.1 share/bash-completion/completions/convoy share/convoy/configs/demo.toml \
    THIRD-PARTY-LICENCES.txt sbom.cdx.json; do
    [[ -s $work/bundle/$file ]] || die "the bundle has no $file"
done
bare "$work/bundle/bin/convoy" --version
start=$SECONDS
bare "$work/bundle/bin/convoy" demo --out "$work/demo" --progress none
echo "the demo took $((SECONDS - start)) s"
bare "$work/bundle/bin/convoy" verify --store "$work/demo"
same bundle "$work/demo"

say "wheel"
"$python" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet "$dist"/convoy_v2x-*.whl
# The environment's own commands, by their names, as a shell finds them.
inside() { env -i PATH="$work/venv/bin:/usr/bin:/bin" HOME="$work" CONVOY_DEVICE=cpu "$@"; }
inside convoy demo --out "$work/demo-wheel" --progress none >"$work/said"
same wheel "$work/demo-wheel"
inside render-sensors --help | grep -q '^Usage: render-sensors' || die "render-sensors does not go by its name"
(cd "$work" && inside python - <<'PYTHON'
import convoy

dataset = convoy.Dataset("demo-wheel")
frame = dataset.scene(0).frame(10)
agent = frame.agent("vehicle_0")
assert agent.points().shape[1] == 4 and len(frame.boxes(valid=True)) > 0
print("opened from Python:", agent.points().shape, len(frame.boxes(valid=True)), "boxes")
PYTHON
)

for root in ${ROOTS:-}; do
    system=$(sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' "$root/etc/os-release")
    say "$system"
    rm -rf "$root/convoy" "$root/demo"
    cp -r "$work/bundle" "$root/convoy"
    # `chroot` needs root; programs ask Linux about themselves in /proc.
    mount --bind /proc "$root/proc"
    code=0
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin CONVOY_DEVICE=cpu chroot "$root" /convoy/bin/convoy demo --out /demo --progress none >"$work/said" || code=$?
    umount "$root/proc"
    [[ $code == 0 ]] || die "$system: the demo ended with $code"
    same "$system" "$root/demo"
    rm -rf "$root/convoy" "$root/demo"
done

if [[ -n ${NATIVE:-} ]]; then
    say "this machine's own build"
    bare "$(realpath "$NATIVE")" demo --out "$work/demo-native" --progress none >"$work/said"
    same native "$work/demo-native"
fi
say "all is well"
