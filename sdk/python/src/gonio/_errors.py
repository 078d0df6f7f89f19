"""What is told when something is wrong."""

from __future__ import annotations

import difflib
import os
import sysconfig
import traceback
from collections.abc import Iterable
from types import TracebackType

#: Characters of an answer that tells an error; a header holds 2^20 bytes.
MOST = 60_000

_SDK = os.path.dirname(os.path.abspath(__file__)) + os.sep
_LIBRARIES = tuple(
    os.path.abspath(path) + os.sep
    for name, path in sysconfig.get_paths().items()
    if name in ("stdlib", "platstdlib", "purelib", "platlib")
)


class GonioError(Exception):
    """A BSDF, or what is said of it, that cannot be served: the message says why."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """How a message about an unknown name ends."""
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    if near:
        return f"did you mean `{near[0]}`?"
    return f"there are {', '.join(known)}" if known else "there are none"


def told(error: BaseException) -> str:
    """An exception in the user's code: what, where (the innermost line that is the
    user's own, not the SDK's or a library's), and the traceback."""
    what = "".join(traceback.format_exception_only(type(error), error)).strip()
    first = _first_of_user(error.__traceback__)
    frames = [f for f in traceback.extract_tb(first) if not f.filename.startswith(_SDK)]
    own = [f for f in frames if not f.filename.startswith(_LIBRARIES) and f.filename[:1] != "<"]
    # A class may itself be part of an installed package.
    where = ""
    if own or frames:
        frame = (own or frames)[-1]
        where = f" ({frame.filename}, line {frame.lineno}, in {frame.name})"
    trace = "".join(traceback.format_exception(type(error), error, first))
    text = f"{what}{where}\n\n{trace}".rstrip()
    return text if len(text) <= MOST else f"{text[: MOST // 2]}\n…\n{text[-MOST // 2 :]}"


def _first_of_user(tb: TracebackType | None) -> TracebackType | None:
    """The traceback without the SDK's frames that lead to the user's."""
    start = tb
    while start is not None and start.tb_frame.f_code.co_filename.startswith(_SDK):
        start = start.tb_next
    return start or tb
