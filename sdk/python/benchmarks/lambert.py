"""A diffuse surface: twenty lines that are measured."""

import numpy as np

import gonio


@gonio.bsdf(dimensions=2, claims={"isotropic": True})
class Lambert:
    """the same radiance in all directions"""

    def __init__(self, albedo: float = gonio.number(0.5, 0, 1, "reflectance")):
        self.albedo = albedo

    def eval(self, wo, wi):
        return np.where((wo[2] > 0) & (wi[:, 2] > 0), self.albedo / np.pi, 0)

    def pdf(self, wo, wi):
        return np.where(wo[2] > 0, np.maximum(wi[:, 2], 0) / np.pi, 0)

    def sample(self, wo, u):
        r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
        wi = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)
        valid = np.full(len(u), wo[2] > 0)
        return wi, np.full(len(u), self.albedo), wi[:, 2] / np.pi, valid


if __name__ == "__main__":
    gonio.serve()
