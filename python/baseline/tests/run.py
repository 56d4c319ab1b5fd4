"""Runs the baseline's tests.

Usage: python3 run.py [STORE [PROGRAM]]
The store is one like that of `tests/across/python.rs`; without it, what needs one is skipped, and without Convoy's PROGRAM what hands
predictions to it. Needs PyTorch (5 GB) and scipy, which CI has not: exit code 77 says what was not looked at. With CONVOY_THOROUGH=1 all
nine models learn a moment until they know it by heart: minutes.
"""

import os
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent


def main() -> int:
    if len(sys.argv) > 1:
        os.environ["CONVOY_STORE"] = sys.argv[1]
    if len(sys.argv) > 2:
        os.environ["CONVOY_PROGRAM"] = sys.argv[2]
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(HERE.parent / "src"), str(HERE.parents[1] / "src"), str(HERE)]
    try:
        import scipy.optimize  # noqa: F401
        import torch
    except ImportError as missing:
        print(f"skipped: {missing.name}, for the baseline")
        return 77
    torch.set_num_threads(1)
    result = unittest.TextTestRunner(verbosity=1).run(unittest.defaultTestLoader.discover(str(HERE)))
    if not result.wasSuccessful() or result.testsRun == 0:
        return 1
    if result.skipped:
        print("skipped: " + "; ".join(sorted({why for _, why in result.skipped})))
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
