"""The reference in Python: Lambert, GGX facets, and both side by side."""

import numpy as np

NONE, DIFFUSE, GLOSSY = 0, 4, 8


def above(wo, wi):
    return (wo[2] > 0) & (wi[:, 2] > 0)


def sample_cosine(u1, u2):
    r, phi = np.sqrt(u1), 2 * np.pi * u2
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u1)], axis=1)


def cosine_pdf(wi):
    return wi[:, 2] / np.pi


def ggx(alpha, h):
    s = h[:, 2] ** 2 * (alpha**2 - 1) + 1
    return alpha**2 / (np.pi * s**2)


def lambda_(alpha, cos):
    tan2 = (1 - cos**2) / cos**2
    return (np.sqrt(1 + alpha**2 * tan2) - 1) / 2


def masking(alpha, wo, wi):
    return 1 / (1 + lambda_(alpha, wo[2]) + lambda_(alpha, wi[:, 2]))


def sample_normal(alpha, u1, u2):
    cos2 = (1 - u1) / (1 + (alpha**2 - 1) * u1)
    r, phi = np.sqrt(1 - cos2), 2 * np.pi * u2
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(cos2)], axis=1)


def normal_pdf(alpha, h):
    return ggx(alpha, h) * h[:, 2]


def half_vector(wo, wi):
    h = wo + wi
    return h / np.linalg.norm(h, axis=1, keepdims=True)


def reflect(wo, h):
    return 2 * (h @ wo)[:, None] * h - wo


def schlick(f0, cos):
    return f0 + (1 - f0) * (1 - cos) ** 5


def fresnel(eta, cos_i):
    cos_t = np.sqrt(1 - (1 - cos_i**2) / eta**2)
    rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return (rs**2 + rp**2) / 2


def facets(alpha, wo, wi):
    """Without the Fresnel term."""
    h = half_vector(wo, wi)
    return ggx(alpha, h) * masking(alpha, wo, wi) / (4 * wo[2] * wi[:, 2])


def facets_pdf(alpha, wo, wi):
    h = half_vector(wo, wi)
    return normal_pdf(alpha, h) / (4 * (h @ wo))


class Brdf:
    """What the three have in common: 0 below the horizon, and weight = f cos / pdf."""

    def eval(self, wo, wi):
        with np.errstate(all="ignore"):
            return np.where(above(wo, wi), self.value(wo, wi), 0)

    def pdf(self, wo, wi):
        with np.errstate(all="ignore"):
            return np.where(above(wo, wi), self.density(wo, wi), 0)

    def sample(self, wo, u1, u2):
        wi, lobe = self.draw(wo, u1, u2)
        pdf = self.pdf(wo, wi)
        with np.errstate(all="ignore"):
            weight = self.eval(wo, wi) * wi[:, 2] / pdf
        return wi, weight, pdf, np.where(above(wo, wi), lobe, NONE)


class Diffuse(Brdf):
    def __init__(self, reflectance):
        self.reflectance = reflectance

    def value(self, wo, wi):
        return np.full(len(wi), self.reflectance / np.pi)

    def density(self, wo, wi):
        return cosine_pdf(wi)

    def draw(self, wo, u1, u2):
        return sample_cosine(u1, u2), np.full(len(u1), DIFFUSE)


class Metal(Brdf):
    def __init__(self, alpha, f0):
        self.alpha, self.f0 = alpha, f0

    def value(self, wo, wi):
        return schlick(self.f0, half_vector(wo, wi) @ wo) * facets(self.alpha, wo, wi)

    def density(self, wo, wi):
        return facets_pdf(self.alpha, wo, wi)

    def draw(self, wo, u1, u2):
        return reflect(wo, sample_normal(self.alpha, u1, u2)), np.full(len(u1), GLOSSY)


class Plastic(Brdf):
    def __init__(self, alpha, eta, ks, reflectance):
        self.alpha, self.eta, self.ks, self.reflectance = alpha, eta, ks, reflectance

    def value(self, wo, wi):
        coat = fresnel(self.eta, half_vector(wo, wi) @ wo) * facets(self.alpha, wo, wi)
        return (1 - self.ks) * self.reflectance / np.pi + self.ks * coat

    def density(self, wo, wi):
        return (1 - self.ks) * cosine_pdf(wi) + self.ks * facets_pdf(self.alpha, wo, wi)

    def draw(self, wo, u1, u2):
        coat = u1 < self.ks
        rest = np.where(coat, u1 / self.ks, (u1 - self.ks) / (1 - self.ks))
        # Both are computed for all rows; a number past 1 is of the other lobe.
        rest = np.clip(rest, 0, np.nextafter(1, 0))
        glossy, diffuse = reflect(wo, sample_normal(self.alpha, rest, u2)), sample_cosine(rest, u2)
        return np.where(coat[:, None], glossy, diffuse), np.where(coat, GLOSSY, DIFFUSE)
