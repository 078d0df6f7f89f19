"""BSDFs of Mitsuba 3, measured by gonio.

    gonio check "python3 mitsuba_bsdf.py roughconductor:alpha=0.1"

serves one plugin, the one that is named; without a name it serves all of them.

Mitsuba's `wi` is the given direction and its `wo` the sampled one: gonio's wo and wi. Its
eval() contains the cosine, and a sample without weight is none. `MITSUBA_VARIANT` chooses
what computes: llvm_ad_rgb (the default; needs LLVM, see DRJIT_LIBLLVM_PATH), scalar_rgb
(much slower), or another one with three channels.
"""

import os
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

import gonio

VARIANT = os.environ.get("MITSUBA_VARIANT", "llvm_ad_rgb")
mi.set_variant(VARIANT)
SCALAR = VARIANT.startswith("scalar")
if not SCALAR:
    dr.set_thread_count(1)  # gonio starts a process for each of its threads

MODES = {"radiance": mi.TransportMode.Radiance, "importance": mi.TransportMode.Importance}

# Mitsuba's kinds of lobes and gonio's. Null passes straight through.
KINDS = {
    mi.BSDFFlags.DiffuseReflection: gonio.REFLECTION | gonio.DIFFUSE,
    mi.BSDFFlags.DiffuseTransmission: gonio.TRANSMISSION | gonio.DIFFUSE,
    mi.BSDFFlags.GlossyReflection: gonio.REFLECTION | gonio.GLOSSY,
    mi.BSDFFlags.GlossyTransmission: gonio.TRANSMISSION | gonio.GLOSSY,
    mi.BSDFFlags.DeltaReflection: gonio.REFLECTION | gonio.DISCRETE,
    mi.BSDFFlags.DeltaTransmission: gonio.TRANSMISSION | gonio.DISCRETE,
    mi.BSDFFlags.Null: gonio.TRANSMISSION | gonio.DISCRETE,
}
KINDS = {int(kind): flags for kind, flags in KINDS.items()}

ON_OFF = ["off", "on"]


def measured(cls):
    """What all of them share: RGB, f32, three random numbers, Mitsuba's conventions."""
    return gonio.bsdf(
        name=cls.__name__.lower(),
        channels=["r", "g", "b"],
        dimensions=3,
        precision="f32",
        claims={"cosine": "included"},
        conventions={"failure": "zero-weight"},
        scalar=False,
    )(cls)


class Plugin:
    """A plugin of Mitsuba, made from its dictionary."""

    def load(self, dictionary):
        self.bsdf = mi.load_dict(dictionary)
        if isinstance(self.bsdf, list):
            (self.bsdf,) = self.bsdf
        if not SCALAR:
            # Else each value of a parameter is another kernel to compile.
            parameters = mi.traverse(self.bsdf)
            for key in parameters.keys():
                if dr.is_array_v(parameters[key]):
                    dr.make_opaque(parameters[key])

    def eval(self, wo, wi, mode):
        value = self.each(wo, mode, wi, lambda context, si, w: self.bsdf.eval(context, si, mi.Vector3f(*w)))
        return rows(value, len(wi), 3)

    def pdf(self, wo, wi, mode):
        value = self.each(wo, mode, wi, lambda context, si, w: self.bsdf.pdf(context, si, mi.Vector3f(*w)))
        return rows(value, len(wi), 1)

    def sample(self, wo, u, mode):
        n = len(u)

        def draw(context, si, u):
            s, weight = self.bsdf.sample(context, si, u[0], mi.Point2f(u[1], u[2]))
            return s.wo, weight, s.pdf, s.sampled_type

        drawn = self.each(wo, mode, u, draw)
        if SCALAR:
            drawn = list(zip(*drawn)) or [(), (), (), ()]
        else:
            dr.eval(drawn)  # one kernel, not one for each array
        wi, weight, pdf, kind = drawn
        wi, weight, pdf = rows(wi, n, 3), rows(weight, n, 3), rows(pdf, n, 1)[:, 0]
        flags = kinds(np.asarray(kind, dtype=np.int64), wi, wo)
        return wi, weight, pdf, flags

    def each(self, wo, mode, table, function):
        """`function` of a surface seen from `wo`, for all rows at once, or for each of
        them where the variant has no arrays."""
        context = mi.BSDFContext(MODES[mode])
        si = mi.SurfaceInteraction3f() if SCALAR else dr.zeros(mi.SurfaceInteraction3f, len(table))
        si.wi = mi.Vector3f(*wo) if SCALAR else mi.Vector3f(*(mi.Float(np.float32([x])) for x in wo))
        si.t = 1
        si.n = [0, 0, 1]
        si.sh_frame = mi.Frame3f([0, 0, 1])
        if SCALAR:
            return [function(context, si, [float(x) for x in row]) for row in np.float32(table)]
        return function(context, si, [mi.Float(column) for column in np.float32(table).T])


def rows(values, n, width):
    """One row a direction, of Dr.Jit's arrays (one column a direction) or a list."""
    if isinstance(values, (list, tuple)):
        return np.array([np.ravel(v) for v in values], dtype=np.float64).reshape(n, width)
    array = np.array(values, dtype=np.float64)
    return np.broadcast_to(array.reshape(width, -1).T, (n, width))


def kinds(kind, wi, wo):
    """gonio's flags. Kinds that do not say the side (hair's) take it from wi."""
    flags = np.zeros(len(wi), dtype=np.int64)
    for bits, meaning in KINDS.items():
        flags = np.where(kind == bits, meaning, flags)
    glossy = kind == int(mi.BSDFFlags.Glossy)
    side = np.where(wi[:, 2] * wo[2] < 0, gonio.TRANSMISSION, gonio.REFLECTION)
    flags = np.where(glossy, side | gonio.GLOSSY, flags)
    # What else there may be is told as no lobe at all, which gonio finds where it has weight.
    return flags


def grey(value):
    return {"type": "rgb", "value": [value, value, value]}


@measured
class Diffuse(Plugin):
    """Lambert's"""

    def __init__(self, reflectance: float = gonio.number(0.5, 0, 1, "reflectance")):
        self.claims = {"isotropic": True, "lossless": reflectance == 1}
        self.load({"type": "diffuse", "reflectance": grey(reflectance)})


@measured
class Conductor(Plugin):
    """a smooth metal"""

    def __init__(self, material: str = gonio.choice(["none", "Cu", "Au", "Al"], "none reflects all")):
        self.claims = {"isotropic": True, "lossless": material == "none"}
        self.load({"type": "conductor", "material": material})


@measured
class RoughConductor(Plugin):
    """a metal with microfacets"""

    def __init__(
        self,
        alpha: float = gonio.number(0.1, 1e-3, 1, "roughness, a slope", role="roughness"),
        stretch: float = gonio.number(1, 0.1, 10, "roughness along y over that along x"),
        distribution: str = gonio.choice(["ggx", "beckmann"], "of normals"),
        sample_visible: str = gonio.choice(["on", "off"], "draws the normals that wo sees"),
        material: str = gonio.choice(["none", "Cu", "Au", "Al"], "none reflects all"),
    ):
        self.claims = {"isotropic": stretch == 1}
        self.load(
            {
                "type": "roughconductor",
                "material": material,
                "alpha_u": alpha,
                "alpha_v": alpha * stretch,
                "distribution": distribution,
                "sample_visible": sample_visible == "on",
            }
        )


def glass(int_ior, ext_ior):
    return {"isotropic": True, "transmissive": True, "eta": int_ior / ext_ior, "transport": "both"}


@measured
class Dielectric(Plugin):
    """smooth glass"""

    def __init__(
        self,
        int_ior: float = gonio.number(1.5, 1, 3, "index of refraction behind"),
        ext_ior: float = gonio.number(1, 1, 3, "index of refraction in front"),
    ):
        self.claims = glass(int_ior, ext_ior) | {"lossless": True}
        self.load({"type": "dielectric", "int_ior": int_ior, "ext_ior": ext_ior})


@measured
class RoughDielectric(Plugin):
    """glass with microfacets"""

    def __init__(
        self,
        alpha: float = gonio.number(0.1, 1e-3, 1, "roughness, a slope", role="roughness"),
        stretch: float = gonio.number(1, 0.1, 10, "roughness along y over that along x"),
        distribution: str = gonio.choice(["ggx", "beckmann"], "of normals"),
        sample_visible: str = gonio.choice(["on", "off"], "draws the normals that wo sees"),
        int_ior: float = gonio.number(1.5, 1, 3, "index of refraction behind"),
        ext_ior: float = gonio.number(1, 1, 3, "index of refraction in front"),
    ):
        self.claims = glass(int_ior, ext_ior) | {"isotropic": stretch == 1}
        self.load(
            {
                "type": "roughdielectric",
                "alpha_u": alpha,
                "alpha_v": alpha * stretch,
                "distribution": distribution,
                "sample_visible": sample_visible == "on",
                "int_ior": int_ior,
                "ext_ior": ext_ior,
            }
        )


@measured
class Plastic(Plugin):
    """a diffuse base under a smooth coat"""

    def __init__(
        self,
        reflectance: float = gonio.number(0.5, 0, 1, "of the base"),
        int_ior: float = gonio.number(1.49, 1, 3, "index of refraction of the coat"),
        nonlinear: str = gonio.choice(ON_OFF, "colours shift by reflection within"),
    ):
        self.claims = {"isotropic": True}
        self.load(
            {
                "type": "plastic",
                "diffuse_reflectance": grey(reflectance),
                "int_ior": int_ior,
                "ext_ior": 1.0,
                "nonlinear": nonlinear == "on",
            }
        )


@measured
class RoughPlastic(Plugin):
    """a diffuse base under a coat with microfacets"""

    def __init__(
        self,
        alpha: float = gonio.number(0.1, 1e-3, 1, "roughness, a slope"),
        reflectance: float = gonio.number(0.5, 0, 1, "of the base"),
        distribution: str = gonio.choice(["ggx", "beckmann"], "of normals"),
        sample_visible: str = gonio.choice(["on", "off"], "draws the normals that wo sees"),
        int_ior: float = gonio.number(1.49, 1, 3, "index of refraction of the coat"),
        nonlinear: str = gonio.choice(ON_OFF, "colours shift by reflection within"),
    ):
        self.claims = {"isotropic": True}
        self.load(
            {
                "type": "roughplastic",
                "alpha": alpha,
                "diffuse_reflectance": grey(reflectance),
                "distribution": distribution,
                "sample_visible": sample_visible == "on",
                "int_ior": int_ior,
                "ext_ior": 1.0,
                "nonlinear": nonlinear == "on",
            }
        )


@measured
class Principled(Plugin):
    """Disney's, with transmission"""

    def __init__(
        self,
        base_color: float = gonio.number(0.5, 0, 1, "grey"),
        roughness: float = gonio.number(0.5, 0, 1, "its square root"),
        anisotropic: float = gonio.number(0, 0, 1, "stretches highlights"),
        metallic: float = gonio.number(0, 0, 1, "share of a metal"),
        spec_trans: float = gonio.number(0, 0, 1, "share of glass in what is no metal"),
        eta: float = gonio.number(1.5, 1, 3, "index of refraction behind"),
        spec_tint: float = gonio.number(0, 0, 1, "tint of the highlight"),
        sheen: float = gonio.number(0, 0, 1, "at the rim"),
        flatness: float = gonio.number(0, 0, 1, "share of fake subsurface scattering"),
        clearcoat: float = gonio.number(0, 0, 1, "a second highlight"),
        clearcoat_gloss: float = gonio.number(0, 0, 1, "of it"),
    ):
        glassy = spec_trans > 0
        self.claims = {"isotropic": anisotropic == 0, "transmissive": glassy}
        if glassy:
            self.claims |= {"eta": eta, "transport": "both"}
        values = {
            "roughness": roughness,
            "anisotropic": anisotropic,
            "metallic": metallic,
            "spec_trans": spec_trans,
            "spec_tint": spec_tint,
            "sheen": sheen,
            "flatness": flatness,
            "clearcoat": clearcoat,
            "clearcoat_gloss": clearcoat_gloss,
        }
        # What is 0 is left out: Mitsuba has lobes for what is named.
        named = {key: value for key, value in values.items() if value or key == "roughness"}
        self.load({"type": "principled", "base_color": grey(base_color), "eta": eta, **named})


@measured
class BlendBSDF(Plugin):
    """a share of a rough metal on a diffuse surface"""

    def __init__(
        self,
        weight: float = gonio.number(0.3, 0, 1, "share of the metal"),
        alpha: float = gonio.number(0.2, 1e-3, 1, "of the metal"),
        reflectance: float = gonio.number(0.5, 0, 1, "of the diffuse surface"),
        nested: str = gonio.choice(ON_OFF, "the metal lies on plastic of that reflectance, blended half and half"),
    ):
        self.claims = {"isotropic": True}
        base = {"type": "diffuse", "reflectance": grey(reflectance)}
        if nested == "on":
            coated = {"type": "roughplastic", "alpha": 0.3, "diffuse_reflectance": grey(reflectance)}
            base = {"type": "blendbsdf", "weight": 0.5, "a": base, "b": coated}
        metal = {"type": "roughconductor", "alpha": alpha, "material": "Au"}
        self.load({"type": "blendbsdf", "weight": weight, "a": base, "b": metal})


@measured
class TwoSided(Plugin):
    """the same on both sides"""

    def __init__(
        self,
        alpha: float = gonio.number(0.3, 1e-3, 1, "roughness of a metal, along x"),
        alpha_v: float = gonio.number(0.1, 1e-3, 1, "along y"),
    ):
        self.claims = {"isotropic": alpha == alpha_v, "two_sided": True}
        metal = {"type": "roughconductor", "alpha_u": alpha, "alpha_v": alpha_v, "material": "Au"}
        self.load({"type": "twosided", "bsdf": metal})


@measured
class Hair(Plugin):
    """a fibre along y, lit and seen at one point of it; no surface, but a density over the
    sphere whose eval() is all that leaves, without a cosine"""

    def __init__(
        self,
        longitudinal_roughness: float = gonio.number(0.3, 0.01, 1, "along the fibre"),
        azimuthal_roughness: float = gonio.number(0.3, 0.01, 1, "around the fibre"),
        scale_tilt: float = gonio.number(2, 0, 10, "of its scales, in degrees"),
        absorption: float = gonio.number(0, 0, 10, "per radius"),
    ):
        self.claims = {"transmissive": True, "reciprocal": False, "lossless": absorption == 0}
        self.load(
            {
                "type": "hair",
                "longitudinal_roughness": longitudinal_roughness,
                "azimuthal_roughness": azimuthal_roughness,
                "scale_tilt": scale_tilt,
                "sigma_a": grey(absorption),
            }
        )


if __name__ == "__main__":
    served = {cls.__name__.lower(): cls for cls in Plugin.__subclasses__()}
    if any(name not in served for name in sys.argv[1:]):
        sys.exit(f"usage: {sys.argv[0]} [{' | '.join(served)}]")
    gonio.serve(*(served[name] for name in sys.argv[1:]))
