"""BSDF files (LBNL/WINDOW XML), as Radiance's library reads, evaluates and samples them.

    gonio check "python3 pyradiance_bsdf.py:xml=../../../tests/data/lbnl/panel_tree3.xml"

The library draws by random numbers of its own and has no pdf. What it says of its draws is
that each carries all that leaves in its direction (direct_hemi): so their density must be
f |cos θ| over that. This density stands for pdf() here, and what gonio finds of it is
whether the library keeps its word.

Angles in degrees go in, so that a direction is exact to some 1e-14.
"""

import numpy as np
from pyradiance import bsdf as radiance

import gonio


@gonio.bsdf(name="xml", channels=["y"], precision="f32", claims={"rng": "internal"}, scalar=False)
class XML:
    """a BSDF file as Radiance samples it; luminance"""

    def __init__(self, xml: str = gonio.file("matrix or tensor tree")):
        self.data = radiance.load_file(xml)
        if self.data is None:
            raise ValueError(f"Radiance cannot read {xml}")
        two_sides = {"transmissive": bool(self.data.tf or self.data.tb)}
        # A measurement is what it is.
        self.claims = {"reciprocal": False, "isotropic": False, **two_sides}

    def eval(self, wo, wi):
        o = angles(wo[None])[0]
        return np.array([radiance.query(self.data, *o, *i)[1] for i in angles(wi)])

    def pdf(self, wo, wi):
        o = angles(wo[None])[0]
        whole = radiance.direct_hemi(self.data, *o, radiance.SAMPLE_ALL)
        return self.eval(wo, wi) * np.abs(wi[:, 2]) / whole if whole > 0 else np.zeros(len(wi))

    def sample(self, wo, u):
        o = angles(wo[None])[0]
        # One at a time: several at once are stratified, each next to the one before.
        drawn = np.concatenate([radiance.sample(self.data, *o, 1, radiance.SAMPLE_ALL) for _ in u])
        drawn = drawn.astype(np.float64)
        length = np.linalg.norm(drawn[:, :3], axis=1, keepdims=True)
        valid = (drawn[:, 4] > 0) & (length[:, 0] > 0)
        wi = np.where(valid[:, None], drawn[:, :3] / np.where(length > 0, length, 1), [0, 0, 1])
        return wi, drawn[:, 4], self.pdf(wo, wi), valid


def angles(w):
    """θ and φ in degrees."""
    theta = np.degrees(np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2]))
    return np.column_stack([theta, np.degrees(np.arctan2(w[:, 1], w[:, 0]))])


if __name__ == "__main__":
    gonio.serve()
