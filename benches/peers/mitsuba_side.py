"""Mitsuba's own ChiSquareTest, with its defaults: one request a line of JSON on
stdin, one answer a line on stdout, as `gonio_side.rs` does for gonio.

A single request and the end of input is what a user's test process does: Python
starts, Mitsuba is imported, kernels are compiled or fetched from Dr.Jit's cache
on disk. A second request in the same process is a warm run.
"""

import json
import sys
from math import cos, radians, sin

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")  # what Mitsuba's unit tests of BSDFs run on without a GPU


def direction(theta: float, phi: float) -> list[float]:
    t, p = radians(theta), radians(phi)
    return [sin(t) * cos(p), sin(t) * sin(p), cos(t)]


def run(request: dict, seed) -> dict:
    bsdf, wi = request["bsdf"], direction(request["theta"], request["phi"])
    if request.get("bug"):
        from bugs import graded  # only then: a user's test has none

        name, size = request["bug"]
        sample_func, pdf_func, dimensions = graded(name, size, bsdf, wi)
    else:
        sample_func, pdf_func = mi.chi2.BSDFAdapter(bsdf["type"], bsdf, wi=wi)
        dimensions = 3
    test = mi.chi2.ChiSquareTest(
        domain=mi.chi2.SphericalDomain(),
        sample_func=sample_func,
        pdf_func=pdf_func,
        sample_dim=dimensions,
        seed=seed,
        **request.get("settings", {}),
    )
    accepted = test.run(quiet=True)  # else it writes its tables where it rejects
    return {
        "rejected": not accepted,
        "p": float(test.p_value),
        "mass": float(test.pdf_sum[0]),
        "samples": test.sample_count,
        "pdf_evaluations": int(test.res.x * test.res.y * test.ires**2),
    }


def main() -> None:
    for line in sys.stdin:
        request = json.loads(line)
        if request.get("threads"):
            dr.set_thread_count(request["threads"])
        seeds = request["seeds"]
        if len(seeds) > 1:
            # A number becomes part of the kernel and each seed would be compiled.
            seeds = [dr.opaque(mi.UInt32, seed) for seed in seeds]
        print(json.dumps([run(request, seed) for seed in seeds]), flush=True)


main()
