#!/usr/bin/env bash
# Makes a release: `make release [DIST=dist]`. docs/install.md says what is in it and what this needs.
#   convoy-VERSION-x86_64-linux-gnu.tar.xz               all programs as one file, completions, manual pages, configurations, licences
#   convoy_v2x-VERSION-py3-none-manylinux_*_x86_64.whl   the same programs and the Python package
#   convoy-VERSION.cdx.json                              what is in them (CycloneDX)
#   SHA256SUMS
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(realpath -m "${1:-dist}")
floor=${FLOOR:-2.28}
target=x86_64-unknown-linux-gnu
built=$(realpath -m "${CARGO_TARGET_DIR:-target}")
tools=$built/release-tools

die() { echo "error: $*" >&2; exit 2; }
say() { echo "== $*"; }
for tool in xz strip objdump sha256sum python3; do
    command -v "$tool" >/dev/null || die "there is no $tool (Debian: xz-utils, binutils, coreutils, python3, python3-venv)"
done
version=$(sed -n '/^\[workspace.package\]/,/^\[dependencies\]/s/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
grep -q "^__version__ = \"$version\"" python/src/convoy/__init__.py || die "python/src/convoy is not of version $version"

# Zig links against the glibc that is named, whatever this machine has.
if [[ ! -x $tools/bin/cargo-zigbuild ]]; then
    say "tools into $tools"
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet ziglang==0.17.1 cargo-zigbuild==0.24.1 hatchling==1.33.0
fi
say "programs for glibc $floor"
PATH=$tools/bin:$PATH cargo zigbuild --release --locked --target "$target.$floor" -p convoy-all

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
name=convoy-$version-x86_64-linux-gnu
bundle=$stage/$name
mkdir -p "$bundle"/{bin,share/convoy,share/man/man1,share/bash-completion/completions,share/zsh/site-functions} \
    "$bundle/share/fish/vendor_completions.d" "$out"
strip -o "$bundle/bin/convoy" "$built/$target/release/convoy-all"
chmod 755 "$bundle/bin/convoy"

say "symbols"
# Every versioned symbol that is asked of glibc must be of the floor or older, and no other library may be needed.
objdump -T "$bundle/bin/convoy" | grep -o 'GLIBC_[0-9][0-9.]*' | sort -Vu >"$stage/symbols"
newest=$(sed 's/GLIBC_//' "$stage/symbols" | tail -n 1)
[[ $(printf '%s\n%s\n' "$newest" "$floor" | sort -V | tail -n 1) == "$floor" ]] \
    || die "a symbol of glibc $newest is asked for, above the floor of $floor"
needed=$(objdump -p "$bundle/bin/convoy" | awk '$1 == "NEEDED" { print $2 }' | sort | xargs)
for library in $needed; do
    case $library in
        libc.so.6 | libm.so.6 | libdl.so.2 | libpthread.so.0 | librt.so.1 | libutil.so.1 | libgcc_s.so.1 | ld-linux-x86-64.so.2) ;;
        *) die "$library is needed, which is not on every machine" ;;
    esac
done
echo "newest symbol: glibc $newest; needed: $needed"

# Stages go by their own names, too. Other programs are commands of `convoy` alone: `view`, `import` or `export` on a PATH would
# stand before those of other people.
mapfile -t stages < <(sed -n 's/^name = "\(.*\)"$/\1/p' pipeline.toml)
for program in "${stages[@]}"; do ln -s convoy "$bundle/bin/$program"; done

say "completions, manual pages, licences"
[[ -d viewer/node_modules/three ]] || npm ci --prefix viewer --silent || die "viewer/node_modules is missing, and npm cannot make it"
convoy=$bundle/bin/convoy
"$convoy" completions bash >"$bundle/share/bash-completion/completions/convoy"
"$convoy" completions zsh >"$bundle/share/zsh/site-functions/_convoy"
"$convoy" completions fish >"$bundle/share/fish/vendor_completions.d/convoy.fish"
"$convoy" man "$bundle/share/man/man1" >/dev/null
cp -r configs "$bundle/share/convoy/configs"
cp LICENSE-* CHANGELOG.md "$bundle/"
cp release/BUNDLE.txt "$bundle/README.txt"
python3 release/contents.py --package convoy-all --version "$version" \
    --licences "$bundle/THIRD-PARTY-LICENCES.txt" --sbom "$out/convoy-$version.cdx.json"
cp "$out/convoy-$version.cdx.json" "$bundle/sbom.cdx.json"
"$convoy" --version

say "bundle"
# The same bytes for the same commit: the order of names, nobody's user, the commit's date.
date=$(git log -1 --format=%cI 2>/dev/null || echo 2026-01-01T00:00:00Z)
tar --sort=name --mtime="$date" --owner=0 --group=0 --numeric-owner -C "$stage" -c "$name" | xz -6 >"$out/$name.tar.xz"

say "wheel"
wheel=$stage/wheel
mkdir -p "$wheel/scripts"
cp release/wheel/* "$wheel/"
cp -r python/src "$wheel/src"
find "$wheel" -name __pycache__ -prune -exec rm -rf {} +
cp LICENSE-* "$bundle/THIRD-PARTY-LICENCES.txt" "$wheel/"
cp "$convoy" "$wheel/scripts/convoy"
# A wheel holds no links: small scripts start the one program under their own names.
for program in "${stages[@]}"; do cp release/wheel/launcher.py "$wheel/scripts/$program"; done
chmod 755 "$wheel/scripts"/*
rm "$wheel/launcher.py"
(cd "$wheel" && CONVOY_VERSION=$version CONVOY_GLIBC=$floor SOURCE_DATE_EPOCH=$(date -d "$date" +%s) \
    "$tools/bin/hatchling" build -t wheel -d "$out")

(cd "$out" && sha256sum "$name.tar.xz" convoy_v2x-"$version"-*.whl "convoy-$version.cdx.json" >SHA256SUMS)
limit=$((45 * 1024 * 1024))
for file in "$out"/convoy_v2x-"$version"-*.whl; do
    [[ $(stat -c %s "$file") -lt $limit ]] || die "$file is larger than 45 MiB"
done
say "made"
ls -l "$out"
