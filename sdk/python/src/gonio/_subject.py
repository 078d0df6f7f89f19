"""An instance that can be called: checks what its functions return."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from typing import Any, NamedTuple, Optional

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
#: The arrays of an answer, by their names on the wire.
Arrays = list[tuple[str, Array]]

#: Flags of a sample, added up; 0 is no sample.
REFLECTION = 1
TRANSMISSION = 2
DIFFUSE = 4
GLOSSY = 8
DISCRETE = 16


class Sample(NamedTuple):
    """What `sample` returns; a tuple of the first three, or more, means the same.

    Of a scalar `sample` all are those of one draw.
    """

    #: (n, 3) unit directions.
    wi: Any
    #: (n,) or (n, channels): f |cos θi|/pdf.
    weight: Any
    #: (n,) in 1/sr; of a discrete sample the probability of its lobe.
    pdf: Any
    #: (n,), or one for all; 0 is no sample. Of bool, they mean `valid`. Left out:
    #: GLOSSY, and REFLECTION or TRANSMISSION by the side of wi.
    flags: Any = None
    #: (n,) of bool: where there is a sample.
    valid: Any = None


class ResultError(Exception):
    """A function of the user's returned something else than numbers of the right shape."""


#: Classes of whose speed was told.
_WARNED: set[str] = set()

#: Points for probing that no symmetry makes equal, on the front side for either `up`.
_WO = np.array([0.36, 0.48, 0.8])
_WI = np.array([[0.48, 0.36, 0.8], [-0.36, 0.8, 0.48]])


class Subject:
    """eval, pdf and sample of `instance` over batches of directions."""

    def __init__(
        self,
        instance: object,
        channels: int,
        dimensions: int,
        conventions: dict[str, object],
        scalar: Optional[bool],
    ) -> None:
        self.name = type(instance).__name__
        self.channels = channels
        self.dimensions = dimensions
        up = conventions.get("up")
        normal = up["normal"] if isinstance(up, dict) else [0, 1, 0] if up == "y" else [0, 0, 1]
        self._normal = np.array(normal, float)
        self._towards = conventions.get("given") == "towards"
        found = {name: _function(instance, name) for name in ("eval", "pdf", "sample")}
        self._functions = {name: f for name, f in found.items() if f is not None}
        self.scalar = self._is_scalar() if scalar is None else scalar

    @property
    def has(self) -> list[str]:
        """The functions that there are."""
        return [name for name in ("eval", "pdf", "sample") if name in self._functions]

    def call(self, name: str, mode: str, wo: Floats, rows: Floats) -> Arrays:
        """Answers a call: `rows` are wi (n, 3), of `sample` u (n, dimensions)."""
        f = self._functions.get(name)
        if f is None:
            raise ResultError(f"{self.name} has no {name}(); it has {', '.join(self.has)}")
        if self.scalar:
            self._warn()
            return self._each(name, f, mode, wo, rows)
        return self._checked(name, f(wo, rows, mode), wo, len(rows))

    def _checked(self, name: str, result: Any, wo: Floats, n: int) -> Arrays:
        """The result of a function over arrays."""
        if name == "eval":
            return [("f", _numbers("eval() returned f", result, n, self.channels))]
        if name == "pdf":
            return [("pdf", _numbers("pdf() returned a pdf", result, n))]
        wi, weight, pdf, flags, valid = _sample(result)
        directions = _numbers("sample() returned wi", wi, n, 3, table=True)
        return [
            ("wi", directions),
            ("weight", _numbers("sample() returned weight", weight, n, self.channels)),
            ("pdf", _numbers("sample() returned pdf", pdf, n)),
            ("flags", self._flags(flags, valid, wo, directions)),
        ]

    def _flags(self, flags: Any, valid: Any, wo: Floats, wi: Array) -> Array:
        """Flags of each sample, by the side of wi where they were left out."""
        n = len(wi)
        if flags is not None and np.asarray(flags).dtype == np.bool_:
            flags, valid = None, flags if valid is None else np.logical_and(flags, valid)
        if flags is None:
            wo_up = (-wo if self._towards else wo) @ self._normal
            other_side = (wi @ self._normal) * wo_up < 0
            found: Array = np.where(other_side, TRANSMISSION | GLOSSY, REFLECTION | GLOSSY)
        elif np.ndim(flags) == 0:
            found = np.full(n, _numbers("sample() returned flags", [flags], 1)[0, 0])
        else:
            found = _numbers("sample() returned flags", flags, n)[:, 0]
        if valid is not None:
            found = np.where(_numbers("sample() returned valid", valid, n)[:, 0] != 0, found, 0)
        return found

    def _each(self, name: str, f: _Function, mode: str, wo: Floats, rows: Floats) -> Arrays:
        """A function of one direction at a time."""
        results = [f(wo, row, mode) for row in rows]
        if name != "sample":
            width = self.channels if name == "eval" else 1
            found = _stacked(f"{name}() returned a value", results, width)
            return [("f" if name == "eval" else "pdf", found)]
        drawn = [k for k, result in enumerate(results) if result is not None]
        samples = [_sample(results[k]) for k in drawn]
        wi = _stacked("sample() returned wi", [s.wi for s in samples], 3)
        # Where flags are bool they mean `valid`, as those of arrays do.
        masks = [isinstance(s.flags, (bool, np.bool_)) for s in samples]
        flags = self._flags(None, None, wo, wi).astype(np.float64)
        for k, (s, mask) in enumerate(zip(samples, masks)):
            if (s.valid is not None and not s.valid) or (mask and not s.flags):
                flags[k] = 0
            elif s.flags is not None and not mask:
                flags[k] = _one("sample() returned flags", s.flags, 1)[0]
        weight = _stacked("sample() returned weight", [s.weight for s in samples], self.channels)
        pdf = _stacked("sample() returned pdf", [s.pdf for s in samples], 1)
        arrays = {"wi": wi, "weight": weight, "pdf": pdf, "flags": flags}
        out = {key: np.zeros((len(rows), *array.shape[1:])) for key, array in arrays.items()}
        for key, array in arrays.items():
            out[key][drawn] = array
        return list(out.items())

    def _warn(self) -> None:
        if self.name not in _WARNED:
            _WARNED.add(self.name)
            print(
                f"gonio: {self.name} takes one direction at a time, which is some fifty times slower than "
                "arrays: wi (n, 3) -> (n,)",
                file=sys.stderr,
                flush=True,
            )

    def _is_scalar(self) -> bool:
        """Whether one direction at a time is what every function wants, by two rows of
        each: what takes arrays need not be asked again."""
        wo = -_WO if self._towards else _WO
        u = np.array([np.linspace(0.3, 0.6, self.dimensions), np.linspace(0.7, 0.2, self.dimensions)])
        for name, f in self._functions.items():
            rows = u if name == "sample" else _WI
            if _works(lambda: self._checked(name, f(wo, rows.copy(), "radiance"), wo, 2)):
                return False
        for name, f in self._functions.items():
            rows = u[:1] if name == "sample" else _WI[:1]
            if not _works(lambda: self._each(name, f, "radiance", wo, rows.copy())):
                return False
        return True


class _Function:
    """A function of the user's, called with the mode of transport if it takes it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function
        self._mode: Optional[str] = None
        try:
            names = inspect.signature(function).parameters
        except (TypeError, ValueError):
            names = {}  # type: ignore[assignment]
        for name in ("mode", "transport"):
            if name in names:
                self._mode = name

    def __call__(self, wo: Floats, rows: Floats, mode: str) -> Any:
        if self._mode is None:
            return self._function(wo, rows)
        return self._function(wo, rows, **{self._mode: mode})


def _function(instance: object, name: str) -> Optional[_Function]:
    found = getattr(instance, name, None)
    return _Function(found) if callable(found) else None


def _works(call: Callable[[], object]) -> bool:
    try:
        call()
    except Exception:
        return False
    return True


def _sample(result: Any) -> Sample:
    """What `sample` returned, as one of the forms that it may have."""
    if isinstance(result, (tuple, list)) and 3 <= len(result) <= 5:
        return Sample(*result)
    if all(hasattr(result, name) for name in ("wi", "weight", "pdf")):
        flags, valid = getattr(result, "flags", None), getattr(result, "valid", None)
        return Sample(result.wi, result.weight, result.pdf, flags, valid)
    expected = "(wi, weight, pdf) or (wi, weight, pdf, flags)"
    raise ResultError(f"sample() returned {_what(result)} where {expected} is expected")


def _numbers(told: str, value: Any, n: int, columns: int = 1, table: bool = False) -> Array:
    """`value` as an array (n, columns) of real numbers; one column may be (n,),
    unless it is a `table`."""
    found = _array(told, value, f"{(n, columns)}" if columns > 1 else f"({n},)")
    if found.shape == (n, columns):
        return found
    if columns == 1 and found.shape == (n,) and not table:
        return found.reshape(n, 1)
    expected = f"{(n, columns)}" if columns > 1 else f"({n},) or {(n, 1)}"
    hint = ""
    if not table and found.ndim == 2 and len(found) == n:
        hint = f'; channels are declared as channels=["r", "g", "b"], and there are {columns} now'
        if columns == 1:
            hint = hint.replace("there are 1", "there is 1")
    raise ResultError(f"{told} of shape {found.shape} where {expected} is expected{hint}")


def _stacked(told: str, values: list[Any], columns: int) -> Array:
    """Values of one direction each as (n, columns)."""
    n = len(values)
    try:
        found = np.asarray(values)
        if found.dtype.kind in "fiub" and found.shape in ((n, columns), (n,) if columns == 1 else None):
            return found.reshape(n, columns)
    except Exception:
        pass  # Which of them is wrong is found below.
    out = np.empty((n, columns))
    for k, value in enumerate(values):
        out[k] = _one(told, value, columns)
    return out


def _one(told: str, value: Any, columns: int) -> Array:
    """`value` of one direction as `columns` real numbers."""
    expected = "a number" if columns == 1 else f"({columns},)"
    found = _array(told, value, expected)
    if found.shape == (columns,):
        return found
    if columns == 1 and found.shape == ():
        return found.reshape(1)
    raise ResultError(f"{told} of shape {found.shape} where {expected} is expected")


def _array(told: str, value: Any, expected: str) -> Array:
    if value is None:
        raise ResultError(f"{told} that is None where {expected} is expected; is a `return` missing?")
    try:
        found = np.asarray(value)
    except Exception as error:
        raise ResultError(f"{told} that is no array where {expected} is expected: {error}") from None
    if found.dtype.kind not in "fiub":
        raise ResultError(f"{told} of {found.dtype} where real numbers of shape {expected} are expected")
    return found


def _what(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    if isinstance(value, (tuple, list)):
        return f"{len(value)} values"
    return "None" if value is None else f"a value of type {type(value).__name__}"
