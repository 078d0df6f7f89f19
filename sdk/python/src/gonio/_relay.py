"""Joins stdin and stdout to a Unix socket: gonio talks to an object in a test through it.

Runs by its path, without the package and numpy, so that it starts at once.
"""

from __future__ import annotations

import os
import socket
import sys
import threading

_MOST = 1 << 20


def main(path: str) -> None:
    """Pumps until either end is done."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as end:
        try:
            end.connect(path)
        except OSError as error:
            sys.exit(f"gonio: the test that has the BSDF cannot be reached at {path}: {error.strerror}")
        answers = threading.Thread(target=_answers, args=(end,), daemon=True)
        answers.start()
        while True:
            calls = os.read(0, _MOST)
            if not calls:
                break
            end.sendall(calls)
        end.shutdown(socket.SHUT_WR)
        answers.join()


def _answers(end: socket.socket) -> None:
    """From the socket to stdout. At its end nothing is left to do, also for whoever waits for stdin."""
    try:
        while True:
            data = memoryview(end.recv(_MOST))
            if not data:
                break
            while data:
                data = data[os.write(1, data) :]
    except OSError:
        pass
    os._exit(0)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m gonio._relay SOCKET")
    try:
        main(sys.argv[1])
    except (OSError, KeyboardInterrupt):
        sys.exit(1)  # One of the ends is gone, which the other knows.
