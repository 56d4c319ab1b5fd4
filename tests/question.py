"""Asks a program at a terminal of its own, and answers with Ctrl-C, then with no; or with yes.

question.py PROGRAM CONFIG STORE no|yes
"""

import os
import pty
import select
import sys
import time

QUESTION = b"do it? [y/N] "


def answered(command: list[str], answer: bytes) -> tuple[int, float, str]:
    """The exit code, how long the end took, seconds, and what was said."""
    process, terminal = pty.fork()
    if process == 0:
        os.execv(command[0], command)
    said = b""
    start = time.monotonic()
    asked = None
    while True:
        ready, _, _ = select.select([terminal], [], [], 0.1)
        if ready:
            try:
                said += os.read(terminal, 4096)
            except OSError:  # The program has ended.
                break
        if asked is None and QUESTION in said:
            asked = time.monotonic()
            os.write(terminal, answer)
        if time.monotonic() - start > 60:
            os.kill(process, 9)
            break
    _, status = os.waitpid(process, 0)
    text = said.decode(errors="replace")
    assert asked is not None, f"nothing was asked:\n{text}"
    return os.waitstatus_to_exitcode(status), time.monotonic() - asked, text


def main() -> None:
    program, config, store, word = sys.argv[1:]
    command = [program, "--config", config, "--store", store, "--progress", "none"]
    answers = [(b"y\n", 0)] if word == "yes" else [(b"\x03", 75), (b"\n", 2), (b"n\n", 2)]
    for answer, expected in answers:
        code, took_s, text = answered(command, answer)
        assert code == expected, f"{answer!r}: exit code {code}:\n{text}"
        assert took_s < 10, f"{answer!r}: {took_s} s"
        assert "traffic.vehicles: 12 -> 13" in text, text


main()
