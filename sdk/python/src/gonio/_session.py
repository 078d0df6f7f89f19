"""Answering calls, one by one, over a wire."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from typing import Any, Optional

import numpy as np

from . import _model
from ._errors import GonioError, did_you_mean, told
from ._subject import Arrays, Floats, ResultError, Subject
from ._wire import Call, Wire

_MODES = ("radiance", "importance")
_NO_NUMBERS = np.empty(0)


class Session:
    """What one gonio at the other end of `wire` asks for.

    `guard` is held while the user's code runs; `failed` hears of its exceptions.
    """

    def __init__(
        self,
        models: Mapping[str, _model.Model],
        wire: Wire,
        parallel: bool = True,
        guard: Optional[AbstractContextManager[object]] = None,
        failed: Callable[[Exception], None] = lambda _: None,
    ) -> None:
        self._models = models
        self._wire = wire
        self._parallel = parallel
        self._guard: AbstractContextManager[object] = guard or nullcontext()
        self._failed = failed
        self._subjects: dict[int, tuple[Subject, dict[str, object]]] = {}
        self._handles = 0
        self._calls: dict[str, Callable[[Call], tuple[dict[str, object], Arrays]]] = {
            "describe": self._describe,
            "create": self._create,
            "eval": self._numbers,
            "pdf": self._numbers,
            "sample": self._numbers,
            "destroy": self._destroy,
        }

    def run(self) -> None:
        """Until the other end has no more calls."""
        self._wire.write(self._description(), [])
        while True:
            call = self._wire.read()
            if call is None:
                return
            self._wire.write(*self._answer(call))

    def _answer(self, call: Call) -> tuple[dict[str, object], Arrays]:
        answer = self._calls.get(call.name)
        if answer is None:
            return {"error": f"no call is `{call.name}`; {did_you_mean(call.name, self._calls)}"}, []
        try:
            with self._guard:
                return answer(call)
        except (GonioError, ResultError) as error:
            self._failed(error)
            return {"error": str(error)}, []
        except Exception as error:
            self._failed(error)
            return {"error": told(error)}, []

    def _description(self) -> dict[str, object]:
        description: dict[str, object] = {"protocol": 1}
        if not self._parallel:
            description["parallel"] = False
        return {**description, "models": [m.description for m in self._models.values()]}

    def _describe(self, call: Call) -> tuple[dict[str, object], Arrays]:
        handle = call.header.get("handle")
        return (self._description() if handle is None else self._subject(call)[1]), []

    def _create(self, call: Call) -> tuple[dict[str, object], Arrays]:
        parameters = call.header.get("parameters", {})
        if not isinstance(parameters, dict):
            raise GonioError(f"create: parameters are {parameters!r} where an object is expected")
        model = _model.named(self._models, str(call.header.get("model")))
        self._handles += 1
        self._subjects[self._handles] = model.create(parameters)
        return {"handle": self._handles, "describe": self._subjects[self._handles][1]}, []

    def _destroy(self, call: Call) -> tuple[dict[str, object], Arrays]:
        self._subject(call)
        del self._subjects[call.header["handle"]]
        return {}, []

    def _numbers(self, call: Call) -> tuple[dict[str, object], Arrays]:
        """eval, pdf and sample."""
        subject, _ = self._subject(call)
        mode = str(call.header.get("mode", _MODES[0]))
        if mode not in _MODES:
            raise GonioError(f"{call.name}: no mode is called `{mode}`; {did_you_mean(mode, _MODES)}")
        columns = subject.dimensions if call.name == "sample" else 3
        rows = _table(call, columns)
        # In wi and u stand all numbers that came, and `rows` counts them where it is told.
        return {}, subject.call(call.name, mode, _vector(call), rows)

    def _subject(self, call: Call) -> tuple[Subject, dict[str, object]]:
        handle: Any = call.header.get("handle")
        if not isinstance(handle, int) or handle not in self._subjects:
            raise GonioError(f"{call.name}: no subject has the handle {handle!r}")
        return self._subjects[handle]


def _table(call: Call, columns: int) -> Floats:
    """The numbers of a call in rows."""
    count = call.numbers.size
    rows = call.header.get("rows", len(call.numbers) if call.numbers.ndim == 2 else None)
    if rows is None and columns:
        rows = count // columns
    if not isinstance(rows, int) or rows < 0 or rows * columns != count:
        raise GonioError(f"{call.name}: {count} numbers are no {rows} rows of {columns}")
    return call.numbers.reshape(rows, columns)


def _vector(call: Call) -> Floats:
    """wo of a call."""
    try:
        wo = np.array(call.header.get("wo"), np.float64)
    except (TypeError, ValueError):
        wo = _NO_NUMBERS
    if wo.shape != (3,):
        raise GonioError(f"{call.name}: wo is {call.header.get('wo')!r} where three numbers are expected")
    return wo
