"""The two wires: frames, and JSON lines for reading."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO, Optional, Protocol

import numpy as np

from ._subject import Arrays, Floats

#: Bytes that a header may have.
LARGEST_HEADER = 1 << 20

_F64 = np.dtype("<f8")


class WireError(Exception):
    """What came is no call, and what would follow it cannot be found."""


@dataclass(frozen=True)
class Call:
    """A call as it came."""

    header: Mapping[str, Any]
    #: wi or u, flat on frames, row-major; empty where the call has none.
    numbers: Floats

    @property
    def name(self) -> str:
        """Which call."""
        return str(self.header.get("call"))


class Wire(Protocol):
    """A way to speak."""

    def read(self) -> Optional[Call]:
        """The next call; None at the end."""

    def write(self, header: Mapping[str, Any], arrays: Arrays) -> None:
        """A description, or an answer."""


class Frames:
    """A length, a JSON header, and arrays of little-endian f64."""

    def __init__(self, reader: BinaryIO, writer: BinaryIO) -> None:
        self._reader = reader
        self._writer = writer

    def read(self) -> Optional[Call]:
        length = self._reader.read(4)
        if not length:
            return None
        size = int.from_bytes(length, "little")
        if len(length) < 4 or size > LARGEST_HEADER:
            raise WireError(f"{length!r} is no length of a header (at most {LARGEST_HEADER} bytes)")
        text = self._reader.read(size)
        header = _object(text) if len(text) == size else None
        count = header.get("bytes", 0) if header is not None else None
        if header is None or not isinstance(count, int) or count < 0 or count % 8 != 0:
            raise WireError(f"{text[:200]!r} is no header of {size} bytes with a number of `bytes`")
        # Its own memory in each call: what is given may be kept, and written to.
        numbers = np.empty(count // 8, _F64)
        view = numbers.view(np.uint8).data
        read = 0
        while read < count:
            more = self._reader.readinto(view[read:])  # type: ignore[attr-defined]
            if not more:
                raise WireError(f"{read} bytes came after a header that announces {count}")
            read += more
        return Call(header, numbers)

    def write(self, header: Mapping[str, Any], arrays: Arrays) -> None:
        total = 8 * sum(a.size for _, a in arrays)
        text = json.dumps({**header, "bytes": total}, separators=(",", ":")).encode()
        # Spaces after the header, so that numbers are aligned, and one write.
        text = text.ljust(len(text) + (4 - len(text)) % 8)
        start = 4 + len(text)
        frame = np.empty(start + total, np.uint8)
        frame[:start] = np.frombuffer(len(text).to_bytes(4, "little") + text, np.uint8)
        numbers = frame[start:].view(_F64)
        for _, array in arrays:
            numbers[: array.size].reshape(array.shape)[...] = array
            numbers = numbers[array.size :]
        _write_all(self._writer, frame.data)


class JsonLines:
    """One JSON object a line."""

    def __init__(self, reader: BinaryIO, writer: BinaryIO) -> None:
        self._reader = reader
        self._writer = writer

    def read(self) -> Optional[Call]:
        line = b"\n"
        while line and not line.strip():
            line = self._reader.readline()
        if not line:
            return None
        header = _object(line)
        if header is None:
            raise WireError(f"{line[:200]!r} is no JSON object")
        rows = header.get("wi", header.get("u", []))
        try:
            # Reads "NaN", "Infinity" and null too.
            return Call(header, np.array(rows, np.float64))
        except (TypeError, ValueError):
            raise WireError(f"{line[:200]!r}: wi or u are no rows of numbers") from None

    def write(self, header: Mapping[str, Any], arrays: Arrays) -> None:
        told = {**header, **{name: _listed(name, array) for name, array in arrays}}
        try:
            text = json.dumps(told, allow_nan=False)
        except ValueError:
            text = json.dumps(_finite(told))
        _write_all(self._writer, memoryview(text.encode() + b"\n"))


#: By their names.
WIRES: Mapping[str, Callable[[BinaryIO, BinaryIO], Wire]] = {"frames": Frames, "json-lines": JsonLines}


def _listed(name: str, array: Any) -> Any:
    """An array as it stands on a line: f, wi and weight in rows, pdf and flags flat."""
    if name not in ("pdf", "flags"):
        return array.tolist()
    flat = array.reshape(-1)
    whole = name == "flags" and bool(np.all(np.isfinite(flat) & (flat == np.floor(flat))))
    return (flat.astype(np.int64) if whole else flat).tolist()


def _finite(value: Any) -> Any:
    """With the numbers that JSON lacks as words."""
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    if isinstance(value, Mapping):
        return {key: _finite(v) for key, v in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_finite(v) for v in value]
    return value


def _object(text: bytes) -> Optional[Mapping[str, Any]]:
    try:
        found = json.loads(text)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def _write_all(writer: BinaryIO, data: memoryview) -> None:
    """Unbuffered files may take a part at a time."""
    while len(data):
        data = data[writer.write(data) or 0 :]
