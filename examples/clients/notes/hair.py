"""hair of Mitsuba 3.9.1, without gonio: two disagreements of sample(), pdf() and eval().

1. Draws of the last lobe (light that was reflected within the fibre twice or more) all
   have sin θ = 0 along the fibre: a curve on the sphere, of which pdf() knows nothing.
   Their share is that of the lobe, and it sits where u0 is largest.
2. ∫pdf and ∫eval fall short of 1: the Bessel function I0 within the longitudinal lobe
   (warp.square_to_rough_fiber_pdf) is a power series cut after ten terms, up to x = 12.
   True values are those of scipy.special.i0e.

    python hair.py
"""

import numpy as np
from scipy.special import i0e

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402

N = 1 << 20


def interaction(theta, phi, n):
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    s = np.sin(theta)
    si.wi = mi.Vector3f(float(s * np.cos(phi)), float(s * np.sin(phi)), float(np.cos(theta)))
    return si


def hair(roughness, absorption):
    sigma = {"type": "rgb", "value": [absorption] * 3}
    return mi.load_dict({"type": "hair", "longitudinal_roughness": roughness, "sigma_a": sigma})


print("1. the last lobe: share of draws with wi.y = 0 exactly, and their u0")
rng = np.random.default_rng(1)
for absorption in (0.0, 0.3):
    for theta in (30, 60, 75):
        u = rng.random((3, N), dtype=np.float32)
        si = interaction(np.radians(theta), np.radians(17), N)
        s, weight = hair(0.3, absorption).sample(mi.BSDFContext(), si, mi.Float(u[0]), mi.Point2f(u[1], u[2]))
        flat = np.array(s.wo.y) == 0
        least = u[0][flat].min()
        print(f"   absorption {absorption}, θ {theta}°: {flat.mean():.4%}; u0 ≥ {least:.6f}, "
              f"which is all u0 from there on: {flat.sum() == (u[0] >= least).sum()}")

print("2. ∫pdf and ∫eval (no absorption: 1), by the midpoint rule")
n = 1500
y = (np.arange(n) + 0.5) * 2 / n - 1
phi = (np.arange(2 * n) + 0.5) * np.pi / n
yy, pp = (a.ravel() for a in np.meshgrid(y, phi))
r = np.sqrt(1 - yy * yy)
w = mi.Vector3f(*(mi.Float(a.astype(np.float32)) for a in (r * np.cos(pp), yy, r * np.sin(pp))))
area = 4 * np.pi / len(yy)
for roughness in (0.1, 0.3, 0.5, 0.7):
    for theta in (30, 75):
        b = hair(roughness, 0.0)
        si = interaction(np.radians(theta), np.radians(17), len(yy))
        pdf = np.array(b.pdf(mi.BSDFContext(), si, w), dtype=np.float64).sum() * area
        value = np.array(b.eval(mi.BSDFContext(), si, w).x, dtype=np.float64).sum() * area
        print(f"   longitudinal roughness {roughness}, θ {theta}°: ∫pdf = {pdf:.5f}, ∫eval = {value:.5f}")

print("   one longitudinal lobe, over its axis: ∫ by Mitsuba's pdf and with scipy's I0")
x, gauss = np.polynomial.legendre.leggauss(4000)
for kappa in (3.0, 9.9, 10.1, 11.8, 14.0, 47.0):
    for theta in (0, 40):
        si_, co = np.sin(np.radians(theta)), np.cos(np.radians(theta))
        v = mi.Vector3f(mi.Float(np.sqrt(1 - x * x).astype(np.float32)), mi.Float(x.astype(np.float32)), 0)
        wi = mi.Vector3f(float(co), float(si_), 0.0)
        p = np.array(mi.warp.square_to_rough_fiber_pdf(v, wi, mi.Vector3f(0, 1, 0), kappa), dtype=np.float64)
        mitsuba = (p * gauss).sum() * 2 * np.pi
        a, c = kappa * co * np.sqrt(1 - x * x), -kappa * si_ * x
        true = (np.exp(a + c - kappa) * i0e(a) * kappa / (1 - np.exp(-2 * kappa)) * gauss).sum()
        print(f"   κ {kappa:5}, θ {theta:2}°: {mitsuba:.5f}, {true:.5f}")

print("   I0 by eleven terms of its series (with the first) over I0")
for x_ in (4.0, 8.0, 10.0, 12.0):
    k = np.arange(11)
    factorial = np.cumprod(np.concatenate([[1.0], k[1:]]))
    series = ((x_ / 2) ** (2 * k) / factorial**2).sum()
    print(f"   x = {x_}: {series / (i0e(x_) * np.exp(x_)):.6f}")
