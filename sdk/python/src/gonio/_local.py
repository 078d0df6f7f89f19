"""An object of this process, served to programs outside of it."""

from __future__ import annotations

import os
import shutil
import socket
import sys
import tempfile
import threading
from types import TracebackType
from typing import BinaryIO, Optional, cast

from . import _model, _relay
from ._errors import GonioError
from ._session import Session
from ._wire import Frames, WireError

_BUFFER = 1 << 16


class Local:
    """Serves `bsdf` at a Unix socket while the context lasts."""

    def __init__(self, bsdf: object) -> None:
        if not hasattr(socket, "AF_UNIX"):
            raise GonioError(
                "an object of a test is served over a Unix socket, which this Python lacks; "
                'write it into a file with gonio.serve() and run gonio check "python3 FILE"'
            )
        model = _model.Model(bsdf)
        self._models = {model.name: model}
        self._guard = threading.Lock()
        #: The first exception that a function raised.
        self.failure: Optional[Exception] = None

    def __enter__(self) -> Local:
        self._folder = tempfile.mkdtemp(prefix="gonio-")
        try:
            self.path = os.path.join(self._folder, "socket")
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self._socket.bind(self.path)
            self._socket.listen()
        except OSError as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise GonioError(f"no Unix socket can be made at {self.path}: {error}") from error
        threading.Thread(target=self._accept, name="gonio", daemon=True).start()
        return self

    def __exit__(
        self,
        kind: Optional[type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        # A thread that waits in accept() is not woken by close() alone.
        try:
            self._socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self._socket.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    @property
    def program(self) -> list[str]:
        """The command that speaks for the object."""
        return [sys.executable, "-IS", os.path.abspath(_relay.__file__), self.path]

    def _accept(self) -> None:
        while True:
            try:
                end, _ = self._socket.accept()
            except OSError:
                return
            threading.Thread(target=self._session, args=(end,), name="gonio", daemon=True).start()

    def _session(self, end: socket.socket) -> None:
        with end, end.makefile("rb", _BUFFER) as reader, end.makefile("wb", 0) as writer:
            # The object need not know of threads: one process at a time, one call at a time.
            wire = Frames(cast(BinaryIO, reader), cast(BinaryIO, writer))
            session = Session(self._models, wire, parallel=False, guard=self._guard, failed=self._failed)
            try:
                session.run()
            except (OSError, WireError):
                pass  # gonio ends a process that took too long; the next connects anew.

    def _failed(self, error: Exception) -> None:
        self.failure = self.failure or error
