"""brdf.py: yours. Three models, three functions each; handout.md has the formulas.

Directions are unit vectors that point away from the surface, whose normal is +z:
cos(theta) is the z of a direction. wo is given, wi is sampled. Each call has one wo, of
shape (3,), and n directions or random numbers: work on arrays, never one by one, which is
fifty times slower. `np.where` chooses between values, after both were computed.
"""

import numpy as np

# Which lobe a sample came from; NONE is no sample.
NONE, DIFFUSE, GLOSSY = 0, 4, 8


class Diffuse:
    def __init__(self, reflectance):
        self.reflectance = reflectance  # in [0, 1]

    def eval(self, wo, wi):
        """f(wo, wi) in 1/sr, without the cosine, (n,); 0 where one of them is below the
        horizon."""
        return np.zeros(len(wi))  # TODO

    def pdf(self, wo, wi):
        """The density with which sample draws wi, per steradian, (n,); 0 where it never
        does."""
        return np.zeros(len(wi))  # TODO

    def sample(self, wo, u1, u2):
        """Draws, from random numbers in [0, 1): wi (n, 3), weight = f cos(theta_i) / pdf
        (n,), pdf (n,) and lobe (n,): DIFFUSE, or NONE where there is no sample."""
        return np.zeros((len(u1), 3)), np.zeros(len(u1)), np.zeros(len(u1)), np.full(len(u1), NONE)  # TODO


class Metal:
    def __init__(self, alpha, f0):
        self.alpha = alpha  # roughness, in [0.05, 1]
        self.f0 = f0  # reflectance of a facet at normal incidence, in [0, 1]

    def eval(self, wo, wi):
        return np.zeros(len(wi))  # TODO

    def pdf(self, wo, wi):
        return np.zeros(len(wi))  # TODO

    def sample(self, wo, u1, u2):
        """The lobe of the metal is GLOSSY."""
        return np.zeros((len(u1), 3)), np.zeros(len(u1)), np.zeros(len(u1)), np.full(len(u1), NONE)  # TODO


class Plastic:
    def __init__(self, alpha, eta, ks, reflectance):
        self.alpha = alpha  # roughness of the coat, in [0.05, 1]
        self.eta = eta  # index of refraction of the coat, in [1, 3]
        self.ks = ks  # share of the coat, in [0.05, 0.95]
        self.reflectance = reflectance  # of the base, in [0, 1]

    def eval(self, wo, wi):
        return np.zeros(len(wi))  # TODO

    def pdf(self, wo, wi):
        return np.zeros(len(wi))  # TODO

    def sample(self, wo, u1, u2):
        """GLOSSY where the coat was drawn from, DIFFUSE where the base was."""
        return np.zeros((len(u1), 3)), np.zeros(len(u1)), np.zeros(len(u1)), np.full(len(u1), NONE)  # TODO
