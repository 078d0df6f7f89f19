"""Mitsuba 3.9.1 without gonio: the draw of visible GGX normals at u = (0, ½), the one point
of the unit disc's rim where its normal is 0/0, in the scalar and in the LLVM variant.

    python corner_of_u.py
"""

import numpy as np

import mitsuba as mi

WO = [0.8281842124238668, 0.25320132363765274, 0.5]

for variant in ("scalar_rgb", "llvm_ad_rgb"):
    mi.set_variant(variant)
    import drjit as dr

    for kind in ("roughconductor", "roughdielectric"):
        bsdf = mi.load_dict({"type": kind, "distribution": "ggx", "alpha": 0.3})
        si = mi.SurfaceInteraction3f() if variant.startswith("scalar") else dr.zeros(mi.SurfaceInteraction3f)
        si.wi = mi.Vector3f(*WO)
        s, weight = bsdf.sample(mi.BSDFContext(), si, 0.0, mi.Point2f(0.0, 0.5))
        print(variant, kind, "wi", np.ravel(s.wo), "pdf", np.ravel(s.pdf), "weight", np.ravel(weight))
