"""Whether a client that pip calls installed loads and computes: `python3 imports.py mitsuba`."""

import sys
from importlib.metadata import version


def mitsuba() -> str:
    import drjit as dr
    import mitsuba as mi

    for variant in ("llvm_ad_rgb", "scalar_rgb"):
        mi.set_variant(variant)
        bsdf = mi.load_dict({"type": "diffuse"})
        si = mi.SurfaceInteraction3f() if variant.startswith("scalar") else dr.zeros(mi.SurfaceInteraction3f, 2)
        si.wi = mi.Vector3f(0, 0, 1)
        pdf = dr.max(bsdf.pdf(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1)), axis=None)
        if abs(float(dr.slice(pdf) if not isinstance(pdf, float) else pdf) - 0.3183099) > 1e-6:
            raise ArithmeticError(f"{variant}: the pdf of diffuse at the normal is {pdf}, not 1/π")
    return f"mitsuba {version('mitsuba')} with drjit {version('drjit')}"


def pyradiance() -> str:
    from pyradiance import bsdf

    for name in ("load_file", "query", "sample", "direct_hemi"):
        getattr(bsdf, name)
    return f"pyradiance {version('pyradiance')}"


if __name__ == "__main__":
    print(globals()[sys.argv[1]](), file=sys.stderr)
