"""Parameters of a model, read from the defaults of its `__init__`."""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping, Sequence
from typing import Any, Optional

from ._errors import GonioError, did_you_mean

_ROLES = ("roughness", "eta")
#: The range of a number that declares none: gonio wants one.
_ANY = 1e30


class _Number(float):
    """A default that is a number, and knows its range."""

    told: dict[str, object]


class _Word(str):
    """A default that is a word, and knows its options; or the path of a file."""

    told: dict[str, object]


def number(
    default: float,
    min: Optional[float] = None,
    max: Optional[float] = None,
    doc: str = "",
    role: Optional[str] = None,
) -> float:
    """A number in [min, max], as the default of an argument of `__init__`.

    `role` is "roughness" (as it falls to `min`, samples gather around the mirror
    direction) or "eta" (at 1 nothing is reflected).
    """
    low, high = -_ANY if min is None else min, _ANY if max is None else max
    if not (low <= default <= high and math.isfinite(low) and math.isfinite(high)):
        wrong = f"number({default!r}, {min!r}, {max!r})"
        raise GonioError(f"{wrong}: the default lies outside of [min, max], or these are not finite")
    if role is not None and role not in _ROLES:
        raise GonioError(f"number(…, role={role!r}): {did_you_mean(str(role), _ROLES)}")
    made = _Number(default)
    made.told = {"type": "number", "default": float(default), "min": float(low), "max": float(high)}
    if role is not None:
        made.told["role"] = role
    if doc:
        made.told["doc"] = doc
    return made


def choice(options: Sequence[str], doc: str = "", default: Optional[str] = None) -> str:
    """One of several words, as the default of an argument of `__init__`; the first of
    them if `default` is left out."""
    if isinstance(options, str) or not options or not all(isinstance(o, str) for o in options):
        raise GonioError(f'choice({options!r}): options are a list of words, as ["smith", "v-cavity"]')
    if default is not None and default not in options:
        raise GonioError(f"choice(…, default={default!r}): {did_you_mean(default, options)}")
    made = _Word(options[0] if default is None else default)
    made.told = {"type": "choice", "options": list(options), "default": str(made)}
    if doc:
        made.told["doc"] = doc
    return made


def file(doc: str = "") -> str:
    """A file that must be given; `__init__` gets its path."""
    made = _Word("")
    made.told = {"type": "file", "doc": doc} if doc else {"type": "file"}
    return made


def declared(cls: type) -> list[dict[str, object]]:
    """The parameters of `cls`, as they are told in its description."""
    found: list[dict[str, object]] = []
    for p in inspect.signature(cls).parameters.values():
        if p.kind in (p.VAR_POSITIONAL, p.VAR_KEYWORD):
            continue
        if isinstance(p.default, (_Number, _Word)):
            found.append({"name": p.name, **p.default.told})
        elif isinstance(p.default, (int, float)) and not isinstance(p.default, bool):
            whole = isinstance(p.default, int) and p.annotation in (int, "int")
            default = p.default if whole else float(p.default)
            found.append({"name": p.name, "type": "number", "default": default, "min": -_ANY, "max": _ANY})
        else:
            raise GonioError(_undeclared(cls, p))
    return found


def _undeclared(cls: type, p: inspect.Parameter) -> str:
    has = "has no default" if p.default is p.empty else f"has the default {p.default!r}"
    what = (
        f'{p.name}=gonio.choice(["off", "on"], "what it does")'
        if isinstance(p.default, (bool, str))
        else f'{p.name}: float = gonio.number(0.5, 0, 1, "what it is")'
    )
    return f"argument `{p.name}` of {cls.__name__}.__init__ {has}; declare it, as {what}, or gonio.file(…)"


def values(cls: type, parameters: Sequence[Mapping[str, object]], given: Mapping[str, Any]) -> dict[str, Any]:
    """Checked arguments for `cls`, from what a call of `create` gives."""
    known = {str(p["name"]): p for p in parameters}
    for name in given:
        if name not in known:
            raise GonioError(f"{cls.__name__} has no parameter `{name}`; {did_you_mean(name, known)}")
    return {name: _value(name, p, given.get(name, p.get("default"))) for name, p in known.items()}


def _value(name: str, p: Mapping[str, Any], value: Any) -> Any:
    if p["type"] == "number":
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise GonioError(f"parameter `{name}` is {value!r} where a number is expected")
        low, high = p["min"], p["max"]
        if not low <= value <= high:
            raise GonioError(f"parameter `{name}` is {value!r}, which lies outside of [{low:g}, {high:g}]")
        # An `int` is a whole number.
        if not isinstance(p["default"], int):
            return float(value)
        if value != math.floor(value):
            raise GonioError(f"parameter `{name}` is {value!r} where a whole number is expected")
        return int(value)
    if not isinstance(value, str):
        what = "the path of a file must be given" if p["type"] == "file" else "a word is expected"
        raise GonioError(f"parameter `{name}` is {value!r}: {what}")
    if p["type"] == "choice" and value not in p["options"]:
        raise GonioError(f"parameter `{name}` is {value!r}; {did_you_mean(value, p['options'])}")
    return value
