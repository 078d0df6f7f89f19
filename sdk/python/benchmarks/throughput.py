"""Rows per second of sample, eval and pdf of a numpy Lambert, called in this process and
over the wire. Both ends share one core, as they would if every core had a gonio."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]

from client import Client  # noqa: E402
from lambert import Lambert  # noqa: E402


def best(call: Callable[[], object], seconds: float, rounds: int = 5) -> float:
    """Seconds of one call: the best of `rounds` averages."""
    call()
    start = time.perf_counter()
    call()
    times = max(1, int(seconds / rounds / max(time.perf_counter() - start, 1e-7)))
    averages = []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(times):
            call()
        averages.append((time.perf_counter() - start) / times)
    return min(averages)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--seconds", type=float, default=0.5, help="for each figure (0.5)")
    options.add_argument("--cores", action="store_true", help="let both ends have a core of their own")
    args = options.parse_args()
    if hasattr(os, "sched_setaffinity") and not args.cores:
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    here, random = Lambert(0.5), np.random.default_rng(1)
    wo = np.array([0.6, 0.0, 0.8])
    print("million rows per second")
    print("  batch   " + "".join(f"{f + ' ' + where:>14}" for f in FUNCTIONS for where in ("here", "wire")))
    with Client([sys.executable, str(HERE / "lambert.py")]) as client:
        client.create()
        for n in (256, 1024, 4096, 16384, 65536):
            u = random.random((n, 2))
            wi = here.sample(wo, u)[0]
            line = f"{n:7}   "
            for f in FUNCTIONS:
                rows = u if f == "sample" else wi
                function = getattr(here, f)
                for seconds in (
                    best(lambda: function(wo, rows), args.seconds),
                    best(lambda: client.call(f, wo, rows), args.seconds),
                ):
                    line += f"{n / seconds / 1e6:14.2f}"
            print(line, flush=True)


FUNCTIONS = ("sample", "eval", "pdf")

if __name__ == "__main__":
    main()
