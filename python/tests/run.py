"""Runs the package's tests against a store.

Usage: python3 run.py STORE [CONVOY]
The store has a scene 0 with two vehicles, an RSU and every sensor, masks at every second frame, and a planned scene 1 that was
not made. CONVOY is the program, for what calls it. Exit code 77: something could not be looked at.
"""

import os
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent


def main() -> int:
    os.environ["CONVOY_STORE"] = sys.argv[1]
    if len(sys.argv) > 2:
        os.environ["CONVOY_PROGRAM"] = sys.argv[2]
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(HERE.parent / "src"), str(HERE)]
    result = unittest.TextTestRunner(verbosity=1).run(unittest.defaultTestLoader.discover(str(HERE)))
    if not result.wasSuccessful() or result.testsRun == 0:
        return 1
    if result.skipped:
        print("skipped: " + "; ".join(sorted({why for _, why in result.skipped})))
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
