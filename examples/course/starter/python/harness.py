"""What gonio calls, made of the classes of brdf.py. Not yours to change: grading puts
the course's own in its place.

    python3 harness.py        speaks with gonio; try: gonio check "python3 harness.py#metal"
"""

import contextlib
import sys

import gonio

# What it prints does not come between gonio's words and ours, while it is imported too.
with contextlib.redirect_stdout(sys.stderr):
    import brdf


class _Brdf:
    """Directions of shape (3,) and (n, 3), random numbers of shape (n, 2)."""

    def sample(self, wo, u):
        wi, weight, pdf, lobe = super().sample(wo, u[:, 0], u[:, 1])
        # 0 is no sample in gonio's flags too.
        return wi, weight, pdf, (lobe != brdf.NONE) * (gonio.REFLECTION + lobe)


@gonio.bsdf(name="diffuse", dimensions=2)
class Diffuse(_Brdf, brdf.Diffuse):
    """Lambert's reflector"""

    def __init__(
        self, reflectance: float = gonio.number(0.5, 0, 1, "share of the light that is reflected")
    ):
        super().__init__(reflectance)

    @property
    def claims(self):
        # A white diffuse reflector loses nothing.
        return {"isotropic": True, "lossless": self.reflectance == 1}


@gonio.bsdf(name="metal", dimensions=2, claims={"isotropic": True})
class Metal(_Brdf, brdf.Metal):
    """GGX facets, Smith's masking, Schlick's Fresnel term"""

    def __init__(
        self,
        alpha: float = gonio.number(0.3, 0.05, 1, "roughness", "roughness"),
        f0: float = gonio.number(0.9, 0, 1, "reflectance of a facet at normal incidence"),
    ):
        super().__init__(alpha, f0)


@gonio.bsdf(name="plastic", dimensions=2, claims={"isotropic": True})
class Plastic(_Brdf, brdf.Plastic):
    """a rough dielectric coat beside a diffuse base"""

    def __init__(
        self,
        alpha: float = gonio.number(0.3, 0.05, 1, "roughness of the coat"),
        eta: float = gonio.number(1.5, 1, 3, "index of refraction of the coat"),
        ks: float = gonio.number(
            0.4, 0.05, 0.95, "share of the coat, and the probability with which it is drawn from"
        ),
        reflectance: float = gonio.number(0.8, 0, 1, "of the base"),
    ):
        super().__init__(alpha, eta, ks, reflectance)


if __name__ == "__main__":
    gonio.serve()
