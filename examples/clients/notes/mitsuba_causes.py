"""Mitsuba 3.9.1 without gonio: why its BSDFs fail, one section for each cause, each by a
formula that is written out here or by plain counting.

    python mitsuba_causes.py
"""

import numpy as np
from scipy.integrate import quad
from scipy.special import erf

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402

N = 1 << 20
RNG = np.random.default_rng(1)
CONTEXT = mi.BSDFContext()


def rgb(v):
    return {"type": "rgb", "value": [v, v, v]}


def vector(theta, phi=17.0):
    t, p = np.radians(theta), np.radians(phi)
    return np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])


def interaction(w, n=1):
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.wi = vec(w)
    return si


def vec(w):
    return mi.Vector3f(*(mi.Float(np.float32(np.atleast_1d(c))) for c in w))


def numbers(a):
    return np.array(a, dtype=np.float64)


def draw(bsdf, w, n=N):
    u = RNG.random((3, n), dtype=np.float32)
    return bsdf.sample(CONTEXT, interaction(w, n), mi.Float(u[0]), mi.Point2f(u[1], u[2]))


def grid(lower, upper, nz=1500, nphi=1500):
    z = lower + (np.arange(nz) + 0.5) * (upper - lower) / nz
    phi = (np.arange(nphi) + 0.5) * 2 * np.pi / nphi
    z, phi = (a.ravel() for a in np.meshgrid(z, phi))
    r = np.sqrt(1 - z * z)
    return vec((r * np.cos(phi), r * np.sin(phi), z)), len(z), (upper - lower) * 2 * np.pi / len(z)


print("A. roughdielectric, sample_visible=False: normals are drawn with α(1.2 − 0.2√cos θ),")
print("   and the weight is that of draws with α. weight·pdf/eval beside D_drawn/D:")
for kind, alpha, theta in (("beckmann", 0.3, 60), ("ggx", 0.3, 60), ("ggx", 0.05, 85), ("beckmann", 1.0, 85)):
    bsdf = mi.load_dict(
        {"type": "roughdielectric", "distribution": kind, "alpha": alpha, "sample_visible": False, "int_ior": 1.5, "ext_ior": 1.0}
    )
    wo = vector(theta)
    s, weight = draw(bsdf, wo)
    value = numbers(bsdf.eval(CONTEXT, interaction(wo, N), s.wo))[0]
    weight, wi, pdf = numbers(weight)[0], numbers(s.wo), numbers(s.pdf)
    k = (weight > 0) & (wi[2] > 1e-2) & (value > 0)  # reflection: the half vector is plain
    m = wi.T[k] + wo
    m /= np.linalg.norm(m, axis=1, keepdims=True)
    t2, c2 = 1 / m[:, 2] ** 2 - 1, m[:, 2] ** 2
    wide = alpha * (1.2 - 0.2 * np.sqrt(wo[2]))

    def density(a):
        if kind == "ggx":
            return 1 / (np.pi * a * a * c2**2 * (1 + t2 / a**2) ** 2)
        return np.exp(-t2 / a**2) / (np.pi * a * a * c2**2)

    found = weight[k] * pdf[k] / value[k]
    named = density(wide) / density(alpha)
    print(
        f"   {kind:8} α {alpha}, θ {theta}°: {found.min():.4f} to {found.max():.4g}; off D_drawn/D by "
        f"{np.abs(found / named - 1).max():.1e}. E[weight] {weight.mean():.4f}, "
        f"with eval/pdf {(value[weight > 0] / pdf[weight > 0]).sum() / N:.4f}"
    )

print("B. beckmann, sample_visible=True: pdf() has G1 by a rational fit (Walter et al. 2007), draws")
print("   have the true one. Fit over true, and ∫pdf of the upper half over the share of draws there:")
for alpha, theta in ((1.0, 60), (1.0, 85), (0.5, 85), (0.1, 85)):
    wo = vector(theta)
    a = 1 / (alpha * np.tan(np.radians(theta)))
    fit = (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) if a < 1.6 else 1.0
    true = 2 / (1 + erf(a) + np.exp(-a * a) / (a * np.sqrt(np.pi)))
    bsdf = mi.load_dict({"type": "roughconductor", "distribution": "beckmann", "alpha": alpha, "material": "none"})
    w, n, area = grid(0, 1)
    mass = numbers(bsdf.pdf(CONTEXT, interaction(wo, n), w)).sum() * area
    drawn = np.mean([(numbers(draw(bsdf, wo)[1])[0] > 0).mean() for _ in range(8)])
    error = np.sqrt(drawn * (1 - drawn) / (8 * N)) / drawn
    print(f"   α {alpha}, θ {theta}°: {fit / true:.5f}, {mass / drawn:.5f} ± {error:.5f}")

print("C. roughplastic: pdf() below the horizon, where eval() is 0. ∫pdf there, the share of draws that")
print("   fall there (their weight is 0), and the mass of the coat's lobe below the horizon by itself:")
for theta in (0, 60, 85):
    wo = vector(theta)
    settings = {"alpha": 0.5, "distribution": "beckmann"}
    bsdf = mi.load_dict({"type": "roughplastic", **settings})
    s, weight = draw(bsdf, wo)
    coat, _ = draw(mi.load_dict({"type": "roughconductor", "material": "none", **settings}), wo)
    w, n, area = grid(-1, 0)
    mass = numbers(bsdf.pdf(CONTEXT, interaction(wo, n), w)).sum() * area
    low, lone = (numbers(s.wo)[2] < 0).mean(), (numbers(coat.wo)[2] < 0).mean()
    print(f"   θ {theta}°: {mass:.4f}, {low:.4f}, {lone:.4f}; weight there {numbers(weight)[0][numbers(s.wo)[2] < 0].max():.1f}")
flat = vector(90)
flat[2] = 0
print("   at wo = wi on the horizon: pdf", float(numbers(bsdf.pdf(CONTEXT, interaction(flat), vec(flat)))[0]),
      "; of roughconductor:", float(numbers(mi.load_dict({"type": "roughconductor"}).pdf(CONTEXT, interaction(flat), vec(flat)))[0]))

print("D. blendbsdf of diffuse and roughconductor, wo exactly on the horizon:")
blend = mi.load_dict({"type": "blendbsdf", "weight": 0.5, "a": {"type": "diffuse"}, "b": {"type": "roughconductor"}})
for u in ((0.0, 0.0, 0.0), (0.4, 0.3, 0.6), (0.7, 0.3, 0.6)):
    for name, bsdf in (("blend", blend), ("roughconductor", mi.load_dict({"type": "roughconductor"}))):
        s, weight = bsdf.sample(CONTEXT, interaction(flat), mi.Float([u[0]]), mi.Point2f([u[1]], [u[2]]))
        print(f"   u {u} {name}: wi {numbers(s.wo)[:, 0]}, pdf {numbers(s.pdf)[0]}, weight {numbers(weight)[0]}")

print("E. plastic, nothing absorbed (reflectance 1, η = 1.49): flux, and what it would be with the")
print("   diffuse Fresnel reflectance from within by quadrature in place of Mitsuba's fit:")


def fresnel(cos_i, eta):
    sin2 = (1 - cos_i * cos_i) / eta**2
    if sin2 >= 1:
        return 1.0
    cos_t = np.sqrt(1 - sin2)
    s, p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t), (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return (s * s + p * p) / 2


eta = 1.49
within = quad(lambda c: 2 * c * fresnel(c, 1 / eta), 0, 1, points=[np.sqrt(1 - 1 / eta**2)], limit=200)[0]
without = quad(lambda c: 2 * c * fresnel(c, eta), 0, 1)[0]
for theta in (0, 60):
    bsdf = mi.load_dict({"type": "plastic", "diffuse_reflectance": rgb(1.0), "int_ior": eta, "ext_ior": 1.0})
    wo = vector(theta)
    w, n, area = grid(0, 1)
    base = numbers(bsdf.eval(CONTEXT, interaction(wo, n), w))[0].sum() * area
    f = fresnel(wo[2], eta)
    true = (1 - f) * (1 - without) / eta**2 / (1 - within)
    print(f"   θ {theta}°: {f + base:.5f}, {f + true:.5f}; 1/(1 − F_within) {base / ((1 - f) * (1 - without) / eta**2):.5f}, {1 / (1 - within):.5f}")

print("F. principled, nothing absorbed (base_color 1): flux of lobes, by plain sums over both sides")
for more, theta in (
    ({"roughness": 0.3, "spec_trans": 0.5}, 60),
    ({"roughness": 0.3}, 60),
    ({"roughness": 0.7}, 0),
    ({"roughness": 0.7}, 85),
    ({"roughness": 0.3, "spec_trans": 1.0}, 60),
):
    wo = vector(theta)
    flux = []
    for extra in ({}, {"base_color": rgb(0.0)}):
        bsdf = mi.load_dict({"type": "principled", "base_color": rgb(1.0), "eta": 1.5, **more, **extra})
        up, n, area = grid(0, 1)
        down, _, _ = grid(-1, 0)
        si = interaction(wo, n)
        top = numbers(bsdf.eval(CONTEXT, si, up))[0].sum() * area
        bottom = numbers(bsdf.eval(CONTEXT, si, down))[0].sum() * area * 1.5**2
        flux.append((top, bottom))
    (top, bottom), (highlight, _) = flux
    print(
        f"   {more}, θ {theta}°: all {top + bottom:.4f} = highlight {highlight:.4f} + base {top - highlight:.4f} "
        f"+ transmission {bottom:.4f}"
    )
r, c = 0.3, np.cos(np.radians(60))


def disney(cos_i, cos_o, cos_d, r):
    fi, fo, rr = (1 - cos_i) ** 5, (1 - cos_o) ** 5, 2 * r * cos_d**2
    return ((1 - fi / 2) * (1 - fo / 2) + rr * (fi + fo + fi * fo * (rr - 1))) / np.pi


z, phi = np.meshgrid((np.arange(800) + 0.5) / 800, (np.arange(800) + 0.5) * 2 * np.pi / 800)
d = np.sqrt((1 + z * c + np.sqrt(1 - z * z) * np.sin(np.radians(60)) * np.cos(phi)) / 2)
print(f"   Burley's diffuse lobe by its formula, roughness {r}, θ 60°: {(disney(c, z, d, r) * z).mean() * 2 * np.pi:.4f}")
