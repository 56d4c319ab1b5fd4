#!python
"""Starts the program of this name: `convoy`, beside this file, is all of them and goes by its name."""
import os
import sys

os.execv(os.path.join(os.path.dirname(os.path.realpath(__file__)), "convoy"), sys.argv)
