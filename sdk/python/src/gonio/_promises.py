"""What is said of a BSDF: claims and conventions, and whether they are spelled right."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict, Union, get_args, get_type_hints

from ._errors import GonioError, did_you_mean


class Claims(TypedDict, total=False):
    """What a BSDF promises; a claim not made is a check skipped, in sight. Left out,
    `reciprocal`, `energy_conserving` and `reflective` are true and the rest false."""

    #: eval(wo, wi)/η_o² = eval(wi, wo)/η_i² in radiance mode.
    reciprocal: bool
    #: No direction reflects and transmits more flux than arrives.
    energy_conserving: bool
    #: All flux that arrives leaves again: the white furnace is 1.
    lossless: bool
    #: Turning wo and wi together about the normal changes nothing.
    isotropic: bool
    #: Light can leave on the side it came from.
    reflective: bool
    #: Light can leave on the other side.
    transmissive: bool
    #: The back side behaves as the front side seen in a mirror.
    two_sided: bool
    #: eval and pdf are random, right on average only.
    stochastic: bool
    #: Index of refraction of the back side over that of the front side.
    eta: float
    #: Whether eval contains |cos θi|.
    cosine: Literal["excluded", "included"]
    #: The modes of transport that it tells apart.
    transport: Literal["radiance", "importance", "both"]
    #: What becomes of draws off the support, as below the horizon.
    off_support: Literal["no-sample", "zero-weight", "never"]
    #: Whether sample draws from the u that gonio passes, or from a generator of its own.
    rng: Literal["external", "internal"]


class Frame(TypedDict):
    """Unit vectors at right angles."""

    normal: Sequence[float]
    tangent: Sequence[float]


class Conventions(TypedDict, total=False):
    """Conventions of the code behind eval, pdf and sample; gonio converts. The first
    value of each is meant where it is left out."""

    #: What sample returns as weight: f |cos θi|/pdf, or what the renderer completes.
    weight: Literal["f-cos-over-pdf", "f-over-pdf", "f-cos", "f"]
    #: How a draw without a sample is told.
    failure: Literal["flags", "zero-pdf", "zero-weight"]
    #: Which axis is the normal, x being the tangent; or the frame that the code shades
    #: with, in the space of a scene.
    up: Union[Literal["z", "y"], Frame]
    #: Whether wo points away from the surface, or along the ray towards it.
    given: Literal["away", "towards"]


_CLAIMS = get_type_hints(Claims)
_CONVENTIONS = get_type_hints(Conventions)


def claims(given: Any, of: str) -> dict[str, object]:
    """Checked claims, as they are told."""
    return _checked(given, _CLAIMS, "claim", f"claims of {of}")


def conventions(given: Any, of: str) -> dict[str, object]:
    """Checked conventions, as they are told."""
    return _checked(given, _CONVENTIONS, "convention", f"conventions of {of}")


def _checked(given: Any, known: Mapping[str, Any], what: str, where: str) -> dict[str, object]:
    if not isinstance(given, Mapping):
        raise GonioError(f'{where}: {given!r} is no dict, as {{"{next(iter(known))}": …}}')
    return {name: _value(name, value, known, what, where) for name, value in given.items()}


def _value(name: Any, value: Any, known: Mapping[str, Any], what: str, where: str) -> object:
    if name not in known:
        raise GonioError(f"{where}: no {what} is called {name!r}; {did_you_mean(str(name), known)}")
    kind = known[name]
    if name == "up" and isinstance(value, Mapping):
        return _frame(value, where)
    if name == "up":
        kind = Literal["z", "y"]
    options = get_args(kind)
    if options:
        if value in options:
            return str(value)
        hint = did_you_mean(value, options) if isinstance(value, str) else f"there are {', '.join(options)}"
        raise GonioError(f"{where}: {name} is {value!r}; {hint}")
    # numpy's numbers and truths too.
    plain = value.item() if hasattr(value, "item") else value
    if kind is bool and isinstance(plain, bool):
        return plain
    if kind is float and isinstance(plain, (int, float)) and not isinstance(plain, bool):
        return float(plain)
    expected = "True or False" if kind is bool else "a number"
    raise GonioError(f"{where}: {name} is {value!r} where {expected} is expected")


def _frame(value: Mapping[Any, Any], where: str) -> object:
    try:
        frame = {name: [float(x) for x in value[name]] for name in ("normal", "tangent")}
    except (KeyError, TypeError, ValueError):
        frame = {}
    if len(value) != 2 or any(len(vector) != 3 for vector in frame.values()) or not frame:
        expected = '{"normal": [0, 0, 1], "tangent": [1, 0, 0]}'
        raise GonioError(f"{where}: up is {value!r} where an axis or {expected} is expected")
    return frame
