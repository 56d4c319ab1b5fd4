"""Says what is built into a program: licences of all crates as one text, and a list of them as CycloneDX.

Of `cargo metadata`, the crates that the program is linked from, for the machine that it is built for; and of the page of
`convoy view`, the packages of viewer/package-lock.json. Nothing is fetched: the texts are those of the sources that cargo has
unpacked, and of viewer/node_modules (`npm ci` there makes it)."""

import argparse
import hashlib
import json
import subprocess
import sys
import tomllib
import urllib.parse
import uuid
from collections import defaultdict
from pathlib import Path
from typing import Any

TARGET = "x86_64-unknown-linux-gnu"
NAMES = ("license", "licence", "copying", "notice", "copyright")


def linked(metadata: dict[str, Any], package: str) -> list[dict[str, Any]]:
    """The crates that a package is linked from, by name and version."""
    packages = {p["id"]: p for p in metadata["packages"]}
    nodes = {n["id"]: n for n in metadata["resolve"]["nodes"]}
    open_ids = [i for i, p in packages.items() if p["name"] == package]
    if not open_ids:
        sys.exit(f"error: there is no package {package}")
    found = set()
    while open_ids:
        at = open_ids.pop()
        if at in found:
            continue
        found.add(at)
        for needed in nodes[at]["deps"]:
            # `null` is what is linked; `build` and `dev` are not.
            if any(kind["kind"] is None for kind in needed["dep_kinds"]):
                open_ids.append(needed["pkg"])
    return sorted((packages[i] for i in found), key=lambda p: (p["name"], p["version"]))


def texts(folder: Path) -> list[str]:
    """The licences that lie in a folder."""
    files = sorted(f for f in folder.iterdir() if f.is_file() and f.name.lower().startswith(NAMES))
    return [f.read_text(encoding="utf-8", errors="replace").strip() for f in files]


def npm_packages(root: Path) -> list[dict[str, Any]]:
    """The packages that the page of `convoy view` is bundled from."""
    lock = json.loads((root / "viewer/package-lock.json").read_text())
    packages = [dict(entry, path=path) for path, entry in lock["packages"].items() if path and not entry.get("dev")]
    return [dict(p, name=p["path"].removeprefix("node_modules/")) for p in packages]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for option in ("--package", "--version", "--licences", "--sbom"):
        parser.add_argument(option, required=True)
    args = parser.parse_args()
    root = Path(__file__).resolve().parent.parent
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", TARGET]
    crates = linked(json.loads(subprocess.run(command, check=True, capture_output=True, cwd=root).stdout), args.package)
    sums = {(p["name"], p["version"]): p.get("checksum") for p in tomllib.loads((root / "Cargo.lock").read_text())["package"]}

    by_text: dict[str, list[str]] = defaultdict(list)
    silent, components = [], []
    for crate in crates:
        if crate["source"] is None:
            # Our own: LICENSE-MIT and LICENSE-APACHE lie beside, but what we ship of others has its licence with it.
            for text in texts(Path(crate["manifest_path"]).parent):
                by_text[text].append(f"{crate['name']}: {crate['description']}")
            continue
        label = f"{crate['name']} {crate['version']} ({crate['license'] or 'see its licence file'})"
        found = texts(Path(crate["manifest_path"]).parent)
        for text in found:
            by_text[text].append(label)
        if not found:
            silent.append(f"{label} {crate['repository'] or ''}".strip())
        checksum = sums.get((crate["name"], crate["version"]))
        components.append({
            "type": "library",
            "bom-ref": f"pkg:cargo/{crate['name']}@{crate['version']}",
            "name": crate["name"],
            "version": crate["version"],
            "purl": f"pkg:cargo/{crate['name']}@{crate['version']}",
            # `/` is an old way to write OR.
            **({"licenses": [{"expression": crate["license"].replace("/", " OR ")}]} if crate["license"] else {}),
            **({"hashes": [{"alg": "SHA-256", "content": checksum}]} if checksum else {}),
        })
    for package in npm_packages(root):
        folder = root / "viewer" / package["path"]
        if not folder.is_dir():
            sys.exit(f"error: {folder} is missing: npm ci --prefix viewer")
        label = f"{package['name']} {package['version']} ({package['license']}), in the page of convoy view"
        for text in texts(folder):
            by_text[text].append(label)
        purl = f"pkg:npm/{urllib.parse.quote(package['name'], safe='/')}@{package['version']}"
        components.append({
            "type": "library", "bom-ref": purl, "name": package["name"], "version": package["version"], "purl": purl,
            "licenses": [{"expression": package["license"]}],
        })

    head = [f"Convoy {args.version} is built from {len(components)} packages of other people, under these licences."]
    if silent:
        head += ["", "No licence text comes with these; the licences that they name are among the texts below:", *silent]
    parts = ["\n".join(head)]
    for text, labels in sorted(by_text.items(), key=lambda item: item[1]):
        parts.append("\n".join(sorted(set(labels))) + "\n\n" + text)
    Path(args.licences).write_text(("\n\n" + "=" * 100 + "\n\n").join(parts) + "\n", encoding="utf-8")

    digest = hashlib.sha256(json.dumps(components, sort_keys=True).encode()).digest()
    sbom = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": f"urn:uuid:{uuid.UUID(bytes=digest[:16], version=4)}",
        "version": 1,
        "metadata": {"component": {
            "type": "application", "bom-ref": "convoy", "name": "convoy", "version": args.version,
            "licenses": [{"expression": "MIT OR Apache-2.0"}],
        }},
        "components": components,
    }
    Path(args.sbom).write_text(json.dumps(sbom, indent=1) + "\n", encoding="utf-8")
    print(f"{len(components)} packages, {len(by_text)} licence texts, {len(silent)} packages without one")


main()
