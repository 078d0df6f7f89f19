"""Makes the XML files of this folder by simulating two simple devices with
Radiance, and reference.json with what Radiance reads from them.

    pip install pyradiance      # 1.3.1 made the committed files
    python3 make.py

Rays are random: another run gives other files, and the tests hold on those too.
"""

import json
import math
import random
import re
import subprocess
import xml.etree.ElementTree as tree
from pathlib import Path

import pyradiance
from pyradiance import bsdf
from pyradiance.genbsdf import BlindsGeometry

HERE = Path(__file__).parent
RAYS = ["-ab", "3", "-ad", "64", "-lw", "1e-3"]

# A translucent sheet with gloss on both sides: 60 % albedo, 4 % specular, 40 % of
# the rest transmitted, 30 % of that specular.
PANEL = b"""
void trans sheet
0
0
7 .6 .6 .6 .04 .2 .4 .3

sheet polygon panel
0
0
12 0 0 -.001  .1 0 -.001  .1 .1 -.001  0 .1 -.001
"""

GLASS = b"""
void glass clear
0
0
3 .9 .9 .9

clear polygon pane
0
0
12 0 0 -.001  .1 0 -.001  .1 .1 -.001  0 .1 -.001
"""


def blind() -> bytes:
    """Glossy slats, tilted by 40°."""
    slats = BlindsGeometry(depth=0.025, width=0.2, height=0.2, nslats=10, angle=40)
    return pyradiance.generate_blinds_for_bsdf(pyradiance.ShadingMaterial(0.6, 0.05, 0.1), slats)


def simulate(name: str, scene: bytes, basis: str, rank: int = 0, log2: int = 4, rays: int = 300) -> None:
    scene_file = HERE / "scene.rad"
    scene_file.write_bytes(scene)
    found = pyradiance.generate_bsdf(
        str(scene_file), basis="kf" if rank else basis, tensortree=rank, ttlog2=log2, nsamp=rays, params=RAYS
    )
    scene_file.unlink()
    xml = pyradiance.generate_xml(vis_results=found, basis=basis, n=name, m="gonio").decode()
    # The same numbers in fewer letters.
    xml = re.sub(r"\d\.\d{3}e[-+]\d\d", lambda m: f"{float(m[0]):g}".replace("0.", ".", 1), xml)
    (HERE / f"{name}.xml").write_text(xml)


def keep_only(name: str, direction: str) -> None:
    """One block of a file: a whole Klems full file has 850 kB."""
    path = HERE / f"{name}.xml"
    blocks = re.split(r"(?=\t<WavelengthData>)|(?=</Layer>)", path.read_text())
    kept = [b for b in blocks if "<WavelengthData>" not in b or f">{direction}<" in b]
    path.write_text("".join(kept))


def reference(name: str) -> dict:
    """Values at random pairs of directions, and hemispherical totals: angles in
    degrees, of the direction that light comes from, then that it goes to."""
    data = bsdf.load_file(str(HERE / f"{name}.xml"))
    random.seed(1)
    angles = lambda: [round(random.uniform(0, 180), 3), round(random.uniform(0, 360), 3)]
    values = [pair + [float(f"{bsdf.query(data, *pair)[1]:.6g}")] for pair in (angles() + angles() for _ in range(80))]
    flux = lambda at, flags: float(f"{bsdf.direct_hemi(data, *at, flags):.6g}")
    # Reflected: SAMPLE_R, transmitted: SAMPLE_T, both with SAMPLE_SP and SAMPLE_DF.
    totals = [at + [flux(at, 13), flux(at, 14)] for at in (angles() for _ in range(24))]
    return {"values": values, "fluxes": totals}


if __name__ == "__main__":
    simulate("blind_klems_quarter", blind(), "kq")
    simulate("glass_klems_full", GLASS, "kf", rays=100)
    keep_only("glass_klems_full", "Transmission Front")
    simulate("panel_tree3", PANEL, "t3", 3, 4)
    simulate("blind_tree4", blind(), "t4", 4, 3)
    names = sorted(p.stem for p in HERE.glob("*.xml"))
    (HERE / "reference.json").write_text(
        json.dumps({name: reference(name) for name in names}).replace("], [", "],\n[") + "\n"
    )
