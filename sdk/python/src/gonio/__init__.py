"""BSDFs in Python for gonio, a goniophotometer for material code.

Write three functions over arrays, and serve them::

    import numpy as np, gonio

    @gonio.bsdf(dimensions=2, claims={"isotropic": True})
    class Lambert:
        def __init__(self, albedo: float = gonio.number(0.5, 0, 1, "reflectance")):
            self.albedo = albedo

        def eval(self, wo, wi):       # wo (3,), wi (n, 3) -> f (n,) or (n, channels)
            ...

        def pdf(self, wo, wi):        # (n,)
            ...

        def sample(self, wo, u):      # u (n, dimensions) -> wi, weight, pdf[, flags]
            ...

    if __name__ == "__main__":
        gonio.serve()

Then ``gonio check "python3 lambert.py"`` measures whether they agree. Directions are
unit vectors in the local frame (+z the normal, +x the tangent) that point away from the
surface; f is in 1/sr, without the cosine; weight is f |cos θi|/pdf.
"""

from ._errors import GonioError
from ._model import bsdf
from ._parameters import choice, file, number
from ._promises import Claims, Conventions
from ._serve import serve
from ._subject import DIFFUSE, DISCRETE, GLOSSY, REFLECTION, TRANSMISSION, Sample

__all__ = [
    "DIFFUSE",
    "DISCRETE",
    "GLOSSY",
    "REFLECTION",
    "TRANSMISSION",
    "Claims",
    "Conventions",
    "GonioError",
    "Sample",
    "bsdf",
    "choice",
    "file",
    "number",
    "serve",
]

__version__ = "0.1.0"
