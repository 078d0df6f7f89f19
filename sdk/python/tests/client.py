"""The other end of the wire: a small client that starts a program and calls it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np


class Refused(Exception):
    """The program answered with an error."""


class Client:
    """A running program that speaks frames, or JSON lines."""

    def __init__(self, command: list[str], wire: str = "frames", **popen: Any) -> None:
        popen.setdefault("env", {**os.environ, "GONIO_WIRE": wire})
        self.lines = wire == "json-lines"
        self.program = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **popen
        )
        self.description, _ = self._read()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> str:
        """Ends the program; what it wrote to standard error."""
        if self.program.stdin and not self.program.stdin.closed:
            self.program.stdin.close()
            self.stderr = self.program.stderr.read().decode()
            self.code = self.program.wait(20)
            self.program.stdout.close()
            self.program.stderr.close()
        return self.stderr

    def send(self, header: dict[str, Any], numbers: np.ndarray | None = None) -> None:
        if self.lines:
            self.program.stdin.write(json.dumps(header).encode() + b"\n")
        else:
            data = b"" if numbers is None else np.ascontiguousarray(numbers, "<f8").tobytes()
            text = json.dumps({**header, "bytes": len(data)}).encode()
            self.program.stdin.write(len(text).to_bytes(4, "little") + text + data)
        self.program.stdin.flush()

    def _read(self) -> tuple[dict[str, Any], np.ndarray]:
        if self.lines:
            line = self.program.stdout.readline()
            assert line, self.close()
            return json.loads(line, parse_constant=_refuse), np.empty(0)
        length = self.program.stdout.read(4)
        assert len(length) == 4, self.close()
        size = int.from_bytes(length, "little")
        assert 2 <= size <= 1 << 20, length
        header = json.loads(self.program.stdout.read(size), parse_constant=_refuse)
        return header, np.frombuffer(self.program.stdout.read(header["bytes"]), "<f8")

    def receive(self) -> tuple[dict[str, Any], np.ndarray]:
        header, numbers = self._read()
        if "error" in header:
            raise Refused(header["error"])
        return header, numbers

    def create(self, model: str | None = None, **parameters: Any) -> dict[str, Any]:
        name = model or self.description["models"][0]["name"]
        self.send({"call": "create", "model": name, "parameters": parameters})
        self.created = self.receive()[0]
        told = {**self.description["models"][0], **self.created.get("describe", {})}
        self.channels = len(told.get("channels", ["value"]))
        return self.created

    def call(self, name: str, wo: Any, rows: Any, mode: str = "radiance") -> dict[str, np.ndarray]:
        """Arrays by their names: f (n, channels), pdf (n,), or those of a sample."""
        rows = np.asarray(rows, float)
        header = {"call": name, "handle": self.created["handle"], "mode": mode, "wo": list(wo)}
        n, c = len(rows), self.channels
        if self.lines:
            self.send({**header, "u" if name == "sample" else "wi": rows.tolist()})
            answer = {k: np.array(v, float) for k, v in self.receive()[0].items()}
        else:
            self.send({**header, "rows": n}, rows)
            _, flat = self.receive()
            shapes = {
                "eval": {"f": (n, c)},
                "pdf": {"pdf": (n,)},
                "sample": {"wi": (n, 3), "weight": (n, c), "pdf": (n,), "flags": (n,)},
            }[name]
            answer = {}
            for key, shape in shapes.items():
                size = int(np.prod(shape))
                answer[key], flat = flat[:size].reshape(shape), flat[size:]
            assert len(flat) == 0
        return answer

    def destroy(self) -> None:
        self.send({"call": "destroy", "handle": self.created["handle"]})
        self.receive()


def _refuse(word: str) -> float:
    raise AssertionError(f"{word} is not JSON")


def python(folder: Path, text: str) -> list[str]:
    """A program in a file."""
    path = folder / "brdf.py"
    path.write_text(text)
    return [sys.executable, str(path)]
