"""Radiance's BSDF library (pyradiance 1.3.1), without gonio: a tensor tree of rank 4 read
at the rim of the disc of incident directions.

Asks f for directions at and near the horizon, every 0.25° of azimuth, in fresh processes.
Values that are negative, huge or not the same in each process were never in the file.

    python radiance_rim.py ../../../tests/data/lbnl/blind_tree4.xml
"""

import subprocess
import sys

import numpy as np


def ask(name):
    from pyradiance import bsdf as radiance

    data = radiance.load_file(name)
    for theta in (80.0, 89.0, 89.9, 89.99, 89.999, 90.0):
        for phi in np.arange(-180, 180, 0.25):
            into = radiance.query(data, theta, phi, 40.0, 17.0)[1]
            out = radiance.query(data, 40.0, 17.0, theta, phi)[1]
            print(theta, phi, into, out)


if len(sys.argv) == 3:
    ask(sys.argv[2])
else:
    runs = []
    for _ in range(3):
        text = subprocess.run([sys.executable, __file__, "--ask", sys.argv[1]], capture_output=True, text=True, check=True)
        runs.append(np.array([[float(x) for x in line.split()] for line in text.stdout.splitlines()]))
    for theta in np.unique(runs[0][:, 0]):
        rows = [r[r[:, 0] == theta] for r in runs]
        for column, what in ((2, "given"), (3, "asked for")):
            values = np.array([r[:, column] for r in rows])
            odd = (np.ptp(values, axis=0) != 0) | (values < 0).any(axis=0) | (values > 100).any(axis=0)
            phi = rows[0][odd, 1]
            print(f"θ {theta}° {what}: {odd.sum()} of {len(odd)} azimuths odd", end="")
            print(f", in {phi.min()}° to {phi.max()}°; there {values[:, odd].min():.3g} to {values[:, odd].max():.3g}" if odd.any() else "")
