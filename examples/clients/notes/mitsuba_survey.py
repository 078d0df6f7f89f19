"""Mitsuba 3 without gonio: for each BSDF, from each direction, by plain sums.

    Z  ∫pdf dω          S  share of draws with weight (not discrete)
    A  E[weight]        R  ∫eval dω + what discrete draws carry
    w  largest relative |weight·pdf − eval| over draws      p  the same of the two pdfs
    r  largest relative asymmetry of f over draws (radiance mode, transmission by η²)

The sums go over 2·1200·2400 midpoints of equal area in cos θ and φ: lobes narrower than
a few such cells are beyond them. Rows off by more than 0.5 % in Z or R are marked.

    python mitsuba_survey.py [NAME…]
"""

import sys

import numpy as np

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402

N = 1 << 20
NZ, NPHI = 2400, 1200
Z = (np.arange(NZ) + 0.5) * 2 / NZ - 1
PHI = (np.arange(NPHI) + 0.5) * 2 * np.pi / NPHI
AREA = 4 * np.pi / (NZ * NPHI)


def rgb(v):
    return {"type": "rgb", "value": [v, v, v]}


def rough(kind, **more):
    return {"type": kind, **more}


SUBJECTS = {
    "diffuse": rough("diffuse", reflectance=rgb(0.5)),
    **{
        f"roughconductor {d} {a} {'visible' if v else 'all'}": rough(
            "roughconductor", distribution=d, alpha=a, sample_visible=v
        )
        for d in ("ggx", "beckmann")
        for a in (0.1, 0.5, 1.0)
        for v in (True, False)
    },
    **{
        f"roughdielectric {d} {a} {'visible' if v else 'all'} {n}": rough(
            "roughdielectric", distribution=d, alpha=a, sample_visible=v, int_ior=n, ext_ior=1.0
        )
        for d, a, v, n in [
            ("ggx", 0.3, True, 1.5),
            ("ggx", 1.0, True, 1.5),
            ("ggx", 0.3, False, 1.5),
            ("ggx", 1.0, False, 2.4),
            ("beckmann", 0.3, True, 2.4),
            ("beckmann", 1.0, True, 1.5),
            ("beckmann", 0.3, False, 1.5),
            ("beckmann", 1.0, False, 1.5),
        ]
    },
    "plastic": rough("plastic", diffuse_reflectance=rgb(0.5)),
    "plastic white nonlinear": rough("plastic", diffuse_reflectance=rgb(1.0), nonlinear=True),
    "plastic white": rough("plastic", diffuse_reflectance=rgb(1.0)),
    **{
        f"roughplastic {d} {a} {'nonlinear' if nl else 'linear'} {c}": rough(
            "roughplastic", distribution=d, alpha=a, nonlinear=nl, diffuse_reflectance=rgb(c)
        )
        for d, a, nl, c in [
            ("ggx", 0.1, False, 0.5),
            ("ggx", 0.5, False, 1.0),
            ("ggx", 0.5, True, 1.0),
            ("beckmann", 0.1, True, 1.0),
            ("beckmann", 0.5, False, 0.5),
        ]
    },
    **{
        "principled " + " ".join(f"{k} {v}" for k, v in more.items()): rough("principled", base_color=rgb(c), **more)
        for c, more in [
            (0.5, {"roughness": 0.3}),
            (0.5, {"roughness": 0.7, "metallic": 0.5}),
            (1.0, {"roughness": 0.7, "metallic": 1.0}),
            (0.5, {"roughness": 0.5, "sheen": 0.5}),
            (0.5, {"roughness": 0.5, "flatness": 0.5}),
            (0.5, {"roughness": 0.5, "clearcoat": 1.0, "clearcoat_gloss": 0.1}),
            (0.5, {"roughness": 0.5, "clearcoat": 1.0, "clearcoat_gloss": 0.9}),
            (0.5, {"roughness": 0.5, "anisotropic": 0.8}),
            (0.5, {"roughness": 0.5, "spec_trans": 0.5, "eta": 1.5}),
            (1.0, {"roughness": 0.7, "spec_trans": 1.0, "eta": 1.5}),
        ]
    },
    "blendbsdf": rough(
        "blendbsdf", weight=0.3, a=rough("diffuse"), b=rough("roughconductor", alpha=0.2, material="Au")
    ),
}


def vector(theta, phi):
    s = np.sin(theta)
    return np.array([s * np.cos(phi), s * np.sin(phi), np.cos(theta)])


def interaction(w, n):
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.wi = mi.Vector3f(*(mi.Float(np.float32(np.atleast_1d(c))) for c in w))
    return si


def grid_sum(function):
    """Sum over the sphere, in slabs so that it fits into memory."""
    total = 0.0
    for slab in np.split(Z, 4):
        z, phi = (a.ravel() for a in np.meshgrid(slab, PHI))
        r = np.sqrt(1 - z * z)
        w = mi.Vector3f(*(mi.Float(np.float32(a)) for a in (r * np.cos(phi), r * np.sin(phi), z)))
        total = total + np.array(function(w, len(z)), dtype=np.float64).sum(axis=-1) * AREA
    return total


def survey(name, dictionary):
    bsdf = mi.load_dict(dictionary)
    context = mi.BSDFContext()
    eta = dictionary.get("int_ior", dictionary.get("eta", 1.0))
    both = dictionary["type"] == "roughdielectric" or "spec_trans" in dictionary
    rng = np.random.default_rng(1)
    for theta in (0, 60, 85) + ((120, 180) if both else ()):
        wo = vector(np.radians(theta), np.radians(17))
        mass = float(grid_sum(lambda w, n: bsdf.pdf(context, interaction(wo, n), w)))
        flux = grid_sum(lambda w, n: bsdf.eval(context, interaction(wo, n), w))[0]
        u = rng.random((3, N), dtype=np.float32)
        si = interaction(wo, N)
        s, weight = bsdf.sample(context, si, mi.Float(u[0]), mi.Point2f(u[1], u[2]))
        pdf, value = bsdf.pdf(context, si, s.wo), bsdf.eval(context, si, s.wo)
        swapped = interaction(np.array(s.wo), N)
        back = bsdf.eval(context, swapped, mi.Vector3f(*(mi.Float(np.full(N, c, np.float32)) for c in wo)))
        weight, value, back = (np.array(a, dtype=np.float64)[0] for a in (weight, value, back))
        p, pdf, wi = np.array(s.pdf, dtype=np.float64), np.array(pdf, dtype=np.float64), np.array(s.wo)
        kind = np.broadcast_to(np.array(s.sampled_type), (N,))
        discrete = (kind & int(mi.BSDFFlags.Delta)) != 0
        drawn = (weight > 0) & ~discrete
        share, mean = drawn.mean(), weight.mean()
        held = flux + weight[discrete].sum() / N
        k = drawn & (np.abs(wi[2]) > 1e-3)
        with np.errstate(divide="ignore", invalid="ignore"):
            ww = np.abs(weight * p / value - 1)[k].max()
            pp = np.abs(p / pdf - 1)[k].max()
            f, g = value / np.abs(wi[2]), back / np.abs(wo[2])
            side = np.where(wi[2] * wo[2] < 0, (eta if wo[2] > 0 else 1 / eta) ** 2, 1.0)
            asymmetry = (np.abs(f * side - g) / np.maximum(f * side, g))[k].max()
        s2 = np.sqrt(max(share * (1 - share), 0) / N)
        sw = weight.std() / np.sqrt(N)
        mark = "  Z" if abs(mass / share - 1) > 0.005 + 4 * s2 / share else ""
        mark += "  R" if abs(held / mean - 1) > 0.005 + 4 * sw / mean else ""
        mark += "  w" if ww > 0.01 else ""
        mark += "  p" if pp > 0.01 else ""
        mark += "  r" if asymmetry > 0.01 else ""
        # Radiance on the other side counts by η² in flux; told of R only where all is on one side.
        print(
            f"{name:46} θ {theta:3}  Z {mass:.4f} S {share:.4f}  A {mean:.4f} R {held:.4f}  "
            f"w {ww:.1e} p {pp:.1e} r {asymmetry:.1e}{mark}",
            flush=True,
        )


for name, dictionary in SUBJECTS.items():
    if not sys.argv[1:] or any(part in name for part in sys.argv[1:]):
        survey(name, dictionary)
