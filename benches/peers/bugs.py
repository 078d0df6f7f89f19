"""The graded bugs, as thin wrappers around what Mitsuba's BSDFAdapter gives.

Each takes its size ε. Names of directions are Mitsuba's: `wi` is given, `wo` is
sampled (gonio's wo and wi).
"""

from collections.abc import Callable

import drjit as dr
import mitsuba as mi

# sample_func, pdf_func and the number of dimensions of u
Functions = tuple[Callable, Callable, int]


def plain(bsdf: dict, wi: list[float]) -> Functions:
    return *mi.chi2.BSDFAdapter(bsdf["type"], bsdf, wi=wi), 3


def pdf_scaled(eps: float, bsdf: dict, wi: list[float]) -> Functions:
    """pdf times 1 + ε."""
    sample, pdf, dimensions = plain(bsdf, wi)
    return sample, lambda wo: pdf(wo) * (1 + eps), dimensions


def alpha_off(eps: float, bsdf: dict, wi: list[float]) -> Functions:
    """Drawn with alpha, pdf of alpha (1 + ε)."""
    sample, _, dimensions = plain(bsdf, wi)
    _, pdf, _ = plain({**bsdf, "alpha": bsdf["alpha"] * (1 + eps)}, wi)
    return sample, pdf, dimensions


def g1_missing(eps: float, bsdf: dict, wi: list[float]) -> Functions:
    """The pdf of visible normals lacks the given direction's G1 to the power ε."""
    sample, pdf, dimensions = plain(bsdf, wi)
    distribution = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, bsdf["alpha"], True)

    def without(wo: mi.Vector3f) -> mi.Float:
        given = mi.Vector3f(wi)
        g1 = distribution.smith_g1(given, dr.normalize(given + wo))
        return dr.select(g1 > 0, pdf(wo) * dr.power(g1, -eps), 0)

    return sample, without, dimensions


def azimuth_shifted(eps: float, bsdf: dict, wi: list[float]) -> Functions:
    """Samples turned about the normal by ε radians."""
    sample, pdf, dimensions = plain(bsdf, wi)

    def turned(u: mi.Vector3f) -> tuple[mi.Vector3f, mi.Float]:
        wo, weight = sample(u)
        s, c = dr.sin(eps), dr.cos(eps)
        return mi.Vector3f(c * wo.x - s * wo.y, s * wo.x + c * wo.y, wo.z), weight

    return turned, pdf, dimensions


def stray_below(eps: float, bsdf: dict, wi: list[float]) -> Functions:
    """A share ε of samples is mirrored below the horizon, where the pdf is 0."""
    sample, pdf, dimensions = plain(bsdf, wi)

    def stray(u: mi.Vector4f) -> tuple[mi.Vector3f, mi.Float]:
        wo, weight = sample(u)
        return mi.Vector3f(wo.x, wo.y, dr.select(u[3] < eps, -wo.z, wo.z)), weight

    return stray, pdf, dimensions + 1


def selection_off(eps: float, bsdf: dict, wi: list[float]) -> Functions:
    """Half diffuse, half the given lobe; the pdf has a share ½(1 + ε) of diffuse."""
    first, first_pdf, _ = plain({"type": "diffuse"}, wi)
    second, second_pdf, dimensions = plain(bsdf, wi)

    def either(u: mi.Vector4f) -> tuple[mi.Vector3f, mi.Float]:
        (a, a_weight), (b, b_weight) = first(u), second(u)
        chosen = u[3] < 0.5
        return dr.select(chosen, a, b), dr.select(chosen, a_weight, b_weight)

    share = 0.5 * (1 + eps)
    return either, lambda wo: share * first_pdf(wo) + (1 - share) * second_pdf(wo), dimensions + 1


BUGS: dict[str, Callable[[float, dict, list[float]], Functions]] = {
    "pdf-scaled": pdf_scaled,
    "alpha-off": alpha_off,
    "g1-missing": g1_missing,
    "azimuth-shifted": azimuth_shifted,
    "stray-below": stray_below,
    "selection-off": selection_off,
}


def graded(name: str, size: float, bsdf: dict, wi: list[float]) -> Functions:
    """A bug by name, of size ε."""
    return BUGS[name](size, bsdf, wi)
