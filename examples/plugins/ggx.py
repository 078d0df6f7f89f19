"""GGX with Smith's masking, as gonio's torrance-sparrow with its defaults (F = 1).

    gonio check "python3 examples/plugins/ggx.py:alpha=0.1"

f = D G2/(4 cos θo cos θi), with masking and shadowing correlated by height
(E. Heitz, Understanding the masking-shadowing function, 2014); normals are drawn that wo
sees (J. Dupuy and A. Benyoub, Sampling visible GGX normals with spherical caps, 2023).
"""

import numpy as np

import gonio


@gonio.bsdf(dimensions=2, claims={"isotropic": True})
class GGX:
    """reflection from GGX microfacets that absorb nothing"""

    def __init__(self, alpha: float = gonio.number(0.2, 1e-4, 1, "roughness, a slope", role="roughness")):
        self.alpha = alpha

    def eval(self, wo, wi):
        front, m = half_vectors(wo, wi)
        # G2/(4 cos θo cos θi) by areas, which are finite up to the horizon.
        o, i = self.masked_area(wo), self.masked_area(wi)
        with np.errstate(divide="ignore", invalid="ignore"):
            f = self.density(m) * 0.25 / (wo[2] * wi[:, 2] + o * wi[:, 2] + i * wo[2])
        return np.where(front, f, 0)

    def pdf(self, wo, wi):
        front, m = half_vectors(wo, wi)
        with np.errstate(divide="ignore", invalid="ignore"):
            pdf = self.density(m) * 0.25 / (wo[2] + self.masked_area(wo))
        return np.where(front, pdf, 0)

    def sample(self, wo, u):
        if wo[2] <= 0:
            nothing = np.zeros(len(u))
            return np.zeros((len(u), 3)), nothing, nothing, nothing
        m = self.visible_normal(wo, u)
        # Not m @ wo, whose rounding depends on how many rows there are.
        om = np.sum(m * wo, axis=-1)
        wi = 2 * om[:, None] * m - wo
        o, i = self.masked_area(wo), self.masked_area(wi)
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = 0.25 / (wo[2] + o)
            pdf = self.density(m) * factor
            weight = 0.25 / (wo[2] * wi[:, 2] + o * wi[:, 2] + i * wo[2]) * wi[:, 2] / factor
        # What falls below the horizon is no sample.
        valid = (om > 0) & (wi[:, 2] > 0) & (pdf > 0) & np.isfinite(pdf) & np.isfinite(weight)
        return wi, weight, pdf, valid

    def density(self, m):
        """D per steradian; ∫D cos θ = 1."""
        x, y, z = (m / [self.alpha, self.alpha, 1]).T
        return 1 / (np.pi * self.alpha**2 * (x * x + y * y + z * z) ** 2)

    def masked_area(self, w):
        """cos θ times Smith's Λ: the projected area of facets turned away from w."""
        x, y, z = (w * [self.alpha, self.alpha, 1]).T
        t2 = x * x + y * y
        length = z + np.sqrt(t2 + z * z)
        return np.where(t2 > 0, 0.5 * t2 / np.where(t2 > 0, length, 1), 0)

    def visible_normal(self, wo, u):
        """The half vector of the stretched view and a point of a spherical cap."""
        x, y, z = normalized(wo * [self.alpha, self.alpha, 1])
        # The cap spans its z from −z to 1; without cancellation.
        top = (1 - u[:, 0]) * (1 + z)
        r = np.sqrt(u[:, 0] * (1 + z) * (top + (x * x + y * y) / (1 + z)))
        phi = 2 * np.pi * u[:, 1]
        m = np.stack([r * np.cos(phi) + x, r * np.sin(phi) + y, top], axis=-1)
        return normalized(m * [self.alpha, self.alpha, 1])


def normalized(v):
    return v * (1 / np.sqrt(np.sum(v * v, axis=-1, keepdims=True)))


def half_vectors(wo, wi):
    """Whether both are in front, and the normals that take wi to wo."""
    m = wo + wi
    length = np.sqrt(np.sum(m * m, axis=-1))
    front = (wo[2] > 0) & (wi[:, 2] > 0) & (length > 0)
    return front, np.where(front[:, None], m / np.where(front, length, 1)[:, None], [0, 0, 1])


if __name__ == "__main__":
    gonio.serve()
