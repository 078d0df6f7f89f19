"""roughdielectric of Mitsuba 3.9.1, without gonio: f near the critical angle of a facet, by
Mitsuba in f32 and by the same formula in f64, both ways of one pair of directions.

    python critical_angle.py
"""

import numpy as np

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402

ALPHA, ETA = 0.3, 1.5
ABOVE = np.array([0.9526657276502964, 0.29125914211683573, 0.08715574274765814])
BELOW = np.array([-0.569049622358658, -0.19042580482787047, -0.7999503360516368])


def fresnel(cos_i, eta):
    eta = eta if cos_i > 0 else 1 / eta
    cos_i = abs(cos_i)
    cos_t2 = 1 - (1 - cos_i**2) / eta**2
    if cos_t2 <= 0:
        return 1.0
    cos_t = np.sqrt(cos_t2)
    s, p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t), (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return (s * s + p * p) / 2


def transmitted(given, asked):
    """f of Walter et al. (2007) with GGX and separable masking, in radiance mode."""
    eta = ETA if given[2] > 0 else 1 / ETA
    m = given + eta * asked
    m *= np.sign(m[2]) / np.linalg.norm(m)
    gm, am = given @ m, asked @ m
    d = 1 / (np.pi * ALPHA**2 * m[2] ** 4 * (1 + (1 / m[2] ** 2 - 1) / ALPHA**2) ** 2)
    g = np.prod([2 / (1 + np.sqrt(1 + ALPHA**2 * (1 / w[2] ** 2 - 1))) for w in (given, asked)])
    f = (1 - fresnel(gm, ETA)) * d * g * abs(gm * am / (given[2] * asked[2])) / (gm + eta * am) ** 2
    return f, gm, am


bsdf = mi.load_dict({"type": "roughdielectric", "distribution": "ggx", "alpha": ALPHA, "int_ior": ETA, "ext_ior": 1.0})
for given, asked in ((ABOVE, BELOW), (BELOW, ABOVE)):
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*map(float, given))
    value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(*map(float, asked)))
    f, gm, am = transmitted(given, asked)
    print(f"given·m {gm:+.6f}, asked·m {am:+.6f}: f64 {f:.4e}, Mitsuba {float(np.array(value)[0, 0]) / abs(asked[2]):.4e}")
