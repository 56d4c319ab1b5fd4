"""Damages so many objects of a store, each once, in one of three ways, and prints their keys."""

import random
import sys
from pathlib import Path


def main() -> None:
    store, count = Path(sys.argv[1]), int(sys.argv[2])
    draw = random.Random(5)
    files = sorted(path for path in store.rglob("*") if path.is_file() and path.stat().st_size > 0)
    # A manifest that is gone takes what it names along: those are told as strays, each by its key.
    shards = [path for path in files if "_manifest" not in str(path)]
    for number, path in enumerate(draw.sample(shards, min(count, len(shards)))):
        data = bytearray(path.read_bytes())
        match number % 3:
            case 0:
                data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
                path.write_bytes(data)
            case 1:
                path.write_bytes(data[: draw.randrange(len(data))])
            case _:
                path.unlink()
        print(path.relative_to(store))


main()
