"""@NAME@: a BSDF for gonio. It is Lambert's reflector, f = reflectance / pi; put
your own in its place.

Directions are unit vectors that point away from the surface, whose normal is +z:
cos(theta) is the z of a direction. wo is given, wi is sampled. Each call has one
wo and thousands of rows: compute them as arrays.
"""

import numpy as np

import gonio


# Claims are what the model is held to: one that is not made is not tested.
@gonio.bsdf(
    name="@NAME@",
    dimensions=2,
    claims={"isotropic": True, "reciprocal": True, "energy_conserving": True},
)
class Lambert:
    """Ideally diffuse reflection."""

    def __init__(
        self,
        # default, min, max, what it is: gonio keeps it between these bounds
        reflectance: float = gonio.number(0.5, 0, 1, "share of the light that is reflected"),
    ):
        self.reflectance = reflectance

    def eval(self, wo, wi):
        """The value in 1/sr, without the cosine: wo (3,), wi (n, 3) -> (n,)."""
        lit = (wo[2] > 0) & (wi[:, 2] > 0)
        return np.where(lit, self.reflectance / np.pi, 0.0)

    def pdf(self, wo, wi):
        """The density of sample per steradian: wo (3,), wi (n, 3) -> (n,)."""
        lit = (wo[2] > 0) & (wi[:, 2] > 0)
        return np.where(lit, wi[:, 2] / np.pi, 0.0)

    def sample(self, wo, u):
        """Draws from u (n, 2) in [0, 1): wi (n, 3), weight (n,) = f cos / pdf,
        pdf (n,) and flags (n,), which are 0 where nothing is drawn."""
        # Points of the unit disc, lifted to the hemisphere: density cos / pi.
        r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
        z = np.sqrt(1 - u[:, 0])
        wi = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)
        weight = np.full(len(u), self.reflectance)  # the cosine and pi cancel
        flags = np.full(len(u), gonio.REFLECTION | gonio.DIFFUSE if wo[2] > 0 else 0)
        return wi, weight, z / np.pi, flags


if __name__ == "__main__":
    gonio.serve()
