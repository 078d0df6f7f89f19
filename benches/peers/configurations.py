"""The same BSDF in Mitsuba's words and in gonio's."""

from dataclasses import dataclass

# Generic: a frame in the wrong basis hides at 0.
PHI = 17.0


@dataclass(frozen=True)
class Configuration:
    label: str
    mitsuba: dict
    gonio: str
    theta: float


def diffuse() -> tuple[str, dict, str]:
    return "diffuse", {"type": "diffuse"}, "lambert"


def conductor(distribution: str, alpha: float) -> tuple[str, dict, str]:
    # Both draw visible normals if not told otherwise. Fresnel is no part of either's
    # pdf; Mitsuba's metal is copper if not told otherwise.
    return (
        f"roughconductor {distribution} α={alpha}",
        {"type": "roughconductor", "distribution": distribution, "alpha": alpha},
        f"torrance-sparrow:distribution={distribution},alpha={alpha},fresnel=conductor,metal=copper",
    )


def dielectric(alpha: float) -> tuple[str, dict, str]:
    return (
        f"roughdielectric ggx α={alpha} η=1.5",
        {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha, "int_ior": 1.5, "ext_ior": 1.0},
        f"rough-dielectric:distribution=ggx,alpha={alpha},eta=1.5",
    )


def configurations(quick: bool) -> list[Configuration]:
    if quick:
        bsdfs = [diffuse(), conductor("ggx", 0.1), dielectric(0.3)]
        thetas = [0.0, 60.0, 85.0]
    else:
        conductors = [conductor(d, a) for d in ("ggx", "beckmann") for a in (0.01, 0.05, 0.1, 0.2, 0.5)]
        bsdfs = [diffuse(), *conductors, *(dielectric(a) for a in (0.1, 0.3))]
        thetas = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0]
    return [Configuration(*bsdf, theta) for bsdf in bsdfs for theta in thetas]


def headline() -> Configuration:
    """GGX of alpha 0.1 at 45°: where power is measured, and the cost that the README quotes."""
    return Configuration(*conductor("ggx", 0.1), 45.0)
