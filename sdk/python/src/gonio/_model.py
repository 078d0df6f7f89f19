"""Classes that are models, and what is said of them."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Optional, TypeVar, Union, overload

from . import _parameters, _promises
from ._errors import GonioError, did_you_mean
from ._promises import Claims, Conventions
from ._subject import Subject

T = TypeVar("T")
Precision = Literal["f32", "f64"]
_FUNCTIONS = ("eval", "pdf", "sample")

#: Decorated classes, in their order.
DECORATED: list[type] = []


@dataclass(frozen=True)
class Declaration:
    """What the decorator was told."""

    name: Optional[str] = None
    doc: Optional[str] = None
    channels: Optional[Sequence[str]] = None
    dimensions: Optional[int] = None
    precision: Optional[Precision] = None
    claims: Mapping[str, object] = field(default_factory=dict)
    conventions: Mapping[str, object] = field(default_factory=dict)
    scalar: Optional[bool] = None


@overload
def bsdf(cls: type[T]) -> type[T]: ...


@overload
def bsdf(
    *,
    name: Optional[str] = None,
    doc: Optional[str] = None,
    channels: Optional[Sequence[str]] = None,
    dimensions: Optional[int] = None,
    precision: Optional[Precision] = None,
    claims: Optional[Claims] = None,
    conventions: Optional[Conventions] = None,
    scalar: Optional[bool] = None,
) -> Callable[[type[T]], type[T]]: ...


def bsdf(
    cls: Optional[type[T]] = None,
    *,
    name: Optional[str] = None,
    doc: Optional[str] = None,
    channels: Optional[Sequence[str]] = None,
    dimensions: Optional[int] = None,
    precision: Optional[Precision] = None,
    claims: Optional[Claims] = None,
    conventions: Optional[Conventions] = None,
    scalar: Optional[bool] = None,
) -> Union[type[T], Callable[[type[T]], type[T]]]:
    """Makes a class with eval, and pdf and sample if it can, a model.

    name: as it is called; from the class's if left out (TorranceSparrow: torrance-sparrow)
    doc: one line about it; the first of the class's docstring if left out
    channels: names of what eval returns for each direction (["value"])
    dimensions: columns of u (3)
    precision: "f32" or "f64", in which it computes; wo, wi and u are f64 in any case
    claims: what it promises, see `Claims`
    conventions: what its code means by weight, wo and so on, see `Conventions`
    scalar: whether its functions take one direction at a time; found out if left out

    `channels`, `dimensions`, `precision`, `claims` and `conventions` may also be
    attributes, properties or methods (without arguments) of the class. They depend on
    the parameters then, and go before what the decorator says, claim by claim.

    The class stays what it is.
    """

    def decorate(cls: type[T]) -> type[T]:
        declaration = Declaration(
            name, doc, channels, dimensions, precision, claims or {}, conventions or {}, scalar
        )
        cls.__gonio__ = declaration  # type: ignore[attr-defined]
        described(cls)
        if cls not in DECORATED:
            DECORATED.append(cls)
        return cls

    return decorate if cls is None else decorate(cls)


class Model:
    """A class, or one instance, that gonio can ask for."""

    def __init__(self, of: object) -> None:
        self._instance = None if isinstance(of, type) else of
        self._class: type = of if isinstance(of, type) else type(of)
        self._parameters = _parameters.declared(self._class) if self._instance is None else []
        declaration = _declaration(self._class)
        self.name = declaration.name or _kebab(self._class.__name__)
        doc = declaration.doc or (self._class.__doc__ or "").strip().partition("\n")[0]
        # What a dataclass writes is no sentence.
        if doc.startswith(f"{self._class.__name__}("):
            doc = ""
        #: As it stands in the plugin's description.
        self.description: dict[str, object] = {"name": self.name}
        if doc:
            self.description["doc"] = doc
        self.description.update(described(of))
        if self._parameters:
            self.description["parameters"] = self._parameters

    def create(self, given: Mapping[str, Any]) -> tuple[Subject, dict[str, object]]:
        """A subject, and what is said of it in particular."""
        instance = self._instance
        arguments = _parameters.values(self._class, self._parameters, given)
        if instance is None:
            instance = self._class(**arguments)
        told = described(instance)
        channels, dimensions = told.get("channels", ["value"]), told.get("dimensions", 3)
        assert isinstance(channels, list) and isinstance(dimensions, int)
        conventions = told.get("conventions", {})
        assert isinstance(conventions, dict)
        scalar = _declaration(self._class).scalar
        if scalar is None:
            attribute = getattr(instance, "scalar", None)
            scalar = attribute if isinstance(attribute, bool) else None
        subject = Subject(instance, len(channels), dimensions, conventions, scalar)
        return subject, told


def described(of: object) -> dict[str, object]:
    """What a class, or an instance of it, says of itself, as it is told. What needs an
    instance is left out of a class's."""
    cls = of if isinstance(of, type) else type(of)
    declaration, name = _declaration(cls), cls.__name__
    told: dict[str, object] = {}
    channels = _said(of, "channels", declaration.channels)
    if channels is not None:
        told["channels"] = _channels(channels, name)
    dimensions = _said(of, "dimensions", declaration.dimensions)
    if dimensions is not None:
        if isinstance(dimensions, bool) or not hasattr(dimensions, "__index__") or int(dimensions) < 0:
            raise GonioError(f"dimensions of {name} are {dimensions!r}; how many numbers does sample take?")
        told["dimensions"] = int(dimensions)
    precision = _said(of, "precision", declaration.precision)
    if precision is not None:
        if precision not in ("f32", "f64"):
            raise GonioError(f'precision of {name} is {precision!r}; there are "f32" and "f64"')
        told["precision"] = precision
    told["has"] = [f for f in _FUNCTIONS if callable(getattr(of, f, None))]
    if not callable(getattr(of, "eval", None)):
        raise GonioError(f"{name} has no eval(wo, wi)")
    claims = _promises.claims(declaration.claims, name)
    claims.update(_promises.claims(_said(of, "claims", {}), name))
    if claims:
        told["claims"] = claims
    conventions = _promises.conventions(declaration.conventions, name)
    conventions.update(_promises.conventions(_said(of, "conventions", {}), name))
    if conventions:
        told["conventions"] = conventions
    return told


def _declaration(cls: type) -> Declaration:
    found = getattr(cls, "__gonio__", None)
    return found if isinstance(found, Declaration) else Declaration()


def _said(of: object, name: str, otherwise: Any) -> Any:
    """The attribute `name` of a class or an instance, or what the decorator says."""
    said = getattr(of, name, None)
    if isinstance(of, type):
        needs_instance = callable(said) or inspect.isdatadescriptor(said) or hasattr(said, "__get__")
        return otherwise if said is None or needs_instance else said
    said = said() if callable(said) else said
    return otherwise if said is None else said


def _channels(given: Any, name: str) -> list[str]:
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise GonioError(f'channels of {name} are {given!r}; write their names, as ["r", "g", "b"]')
    names = [str(c) for c in given]
    if not 1 <= len(names) <= 16:
        raise GonioError(f"{name} has {len(names)} channels; 1 to 16 can be measured")
    return names


def _kebab(name: str) -> str:
    """TorranceSparrow, GGXConductor: torrance-sparrow, ggx-conductor."""
    parted = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "-", name)
    return parted.replace("_", "-").strip("-").lower()


def models(of: Sequence[object]) -> dict[str, Model]:
    """Models by their names; those decorated if `of` is empty."""
    if not of and not DECORATED:
        raise GonioError("nothing to serve: decorate a class with @gonio.bsdf, or write serve(Class)")
    found: dict[str, Model] = {}
    for one in of or DECORATED:
        model = Model(one)
        if model.name in found:
            raise GonioError(f"two models are called `{model.name}`; give one of them another: name=…")
        found[model.name] = model
    return found


def named(models: Mapping[str, Model], name: str) -> Model:
    """The one that is called so."""
    if name not in models:
        raise GonioError(f"no model is called `{name}`; {did_you_mean(name, models)}")
    return models[name]
