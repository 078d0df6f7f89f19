"""Serving BSDFs as a program, over stdin and stdout."""

from __future__ import annotations

import io
import os
import sys
from typing import BinaryIO, Optional

from . import _model
from ._errors import GonioError, did_you_mean
from ._session import Session
from ._wire import WIRES, WireError

#: Bytes that a pipe should hold, where the system lets it.
_PIPE = 1 << 20


def serve(*of: object, wire: Optional[str] = None, parallel: bool = True) -> None:
    """Answers gonio until it ends: ``gonio check "python3 brdf.py"``.

    of: classes, or instances; every decorated class if left out
    wire: "frames", or "json-lines" for reading; $GONIO_WIRE, or frames, if left out
    parallel: whether several processes of this program may run at a time

    What is printed goes to standard error from here on, also by C code; standard input
    is empty.
    """
    wire = wire or os.environ.get("GONIO_WIRE") or "frames"
    if wire not in WIRES:
        raise GonioError(f"no wire is called {wire!r}; {did_you_mean(wire, WIRES)}")
    models = _model.models(of)
    if wire == "frames" and sys.stdin is not None and sys.stdin.isatty():
        program = os.path.basename(sys.argv[0]) or "brdf.py"
        sys.exit(
            f'This program answers gonio: type gonio check "python3 {program}", or set GONIO_WIRE=json-lines '
            "to speak with it by hand."
        )
    reader, writer = _take_over()
    try:
        Session(models, WIRES[wire](reader, writer), parallel).run()
    except WireError as error:
        sys.exit(f"gonio: the wire broke: {error}")
    except (BrokenPipeError, ConnectionResetError):
        sys.exit("gonio: whoever asked is gone")
    except KeyboardInterrupt:
        sys.exit(130)


def _take_over() -> tuple[BinaryIO, BinaryIO]:
    """The wire; in its place stand nothing to read, and standard error to write to."""
    into, out = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    # What was printed before and is still held back goes there too.
    if sys.stdout is not None:
        sys.stdout.flush()
    sys.stdout = sys.stderr
    if sys.platform == "win32":
        import msvcrt

        for fd in (into, out):
            msvcrt.setmode(fd, os.O_BINARY)
    for fd in (into, out):
        _widen(fd)
    reader = io.BufferedReader(io.FileIO(into, "r"), 1 << 16)
    return reader, io.FileIO(out, "w")


def _widen(fd: int) -> None:
    """Fewer changes between the two programs for each call."""
    if sys.platform == "linux":
        import fcntl

        try:
            # F_SETPIPE_SZ, which the module names since Python 3.10.
            fcntl.fcntl(fd, 1031, _PIPE)
        except OSError:
            pass  # No pipe, or no leave for one so large.
