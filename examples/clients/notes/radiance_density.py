"""Radiance's BSDF library (pyradiance 1.3.1), without gonio: do its draws have the density
f |cos θ| / direct_hemi?

Counts 2^20 draws in 2·10·20 cells of equal projected area, and sums f over a grid of 60×60
points within each cell. f is a table of patches: the sum is exact but for cells that
patches cut, by some 1/60 of the jump there. Draws are one a call, so that they are
independent. Prints the sum over the sphere beside 1, Pearson's X² over its degrees of
freedom, and √D: the root mean square by which cells are off, less what chance explains.

    python radiance_density.py ../../../tests/data/lbnl/*.xml
"""

import sys
from pathlib import Path

import numpy as np
from pyradiance import bsdf as radiance

N, RINGS, SECTORS, FINE = 1 << 20, 10, 20, 60


def cell_directions():
    """Grid points of all cells: θ and φ in degrees, [side, ring, sector, point]."""
    s2 = (np.arange(RINGS * FINE) + 0.5) / (RINGS * FINE)
    phi = (np.arange(SECTORS * FINE) + 0.5) * 360 / (SECTORS * FINE)
    theta = np.degrees(np.arcsin(np.sqrt(s2)))
    return theta, phi


def main():
    theta, phi = cell_directions()
    for name in sys.argv[1:]:
        data = radiance.load_file(name)
        for t in (40.0, 140.0):
            whole = radiance.direct_hemi(data, t, 17.0, radiance.SAMPLE_ALL)
            if whole <= 0:
                continue
            expected = np.zeros((2, RINGS, SECTORS))
            for side in (0, 1):
                th = theta if side == 0 else 180 - theta
                f = np.array([[radiance.query(data, t, 17.0, a, b)[1] for b in phi] for a in th])
                mean = f.reshape(RINGS, FINE, SECTORS, FINE).mean(axis=(1, 3))
                expected[side] = mean * np.pi / (RINGS * SECTORS) / whole
            w = np.concatenate([radiance.sample(data, t, 17.0, 1, radiance.SAMPLE_ALL) for _ in range(N)])
            length = np.linalg.norm(w[:, :3], axis=1)
            x, y, z = (w[:, :3] / length[:, None]).T.astype(float)
            ring = np.minimum((x * x + y * y) * RINGS, RINGS - 1).astype(int)
            sector = np.minimum((np.degrees(np.arctan2(y, x)) % 360) * SECTORS / 360, SECTORS - 1).astype(int)
            counts = np.zeros_like(expected)
            np.add.at(counts, ((z < 0).astype(int), ring, sector), 1)
            mean = expected * N
            big = mean > 25
            x2 = ((counts - mean)[big] ** 2 / mean[big]).sum()
            off = max(x2 - big.sum(), 0) / N
            print(f"{Path(name).name} θ {t:.0f}°: direct_hemi {whole:.4f}, ∫pdf {expected.sum():.5f}, "
                  f"X²/{big.sum()} = {x2 / big.sum():.3f}, √D {np.sqrt(off):.3%}, "
                  f"draws where pdf = 0: {counts[expected == 0].sum():.0f}, |w| − 1 ≤ {np.abs(length - 1).max():.1e}")


main()
