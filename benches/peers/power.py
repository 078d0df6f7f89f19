"""The smallest error that is found in 95 % of runs."""

import json
from dataclasses import replace
from math import ceil
from pathlib import Path
from typing import Any

from children import MITSUBAS_TERMS, Child, Terms, Tools, gonio_child, gonio_request, mitsuba_child, mitsuba_request
from configurations import Configuration, conductor, headline

# The bugs of `bugs.py`, as tables name them.
GRADED = {
    "pdf-scaled": "pdf scaled by 1 + ε",
    "alpha-off": "pdf of α(1 + ε)",
    "g1-missing": "pdf lacks G1(given)^ε",
    "azimuth-shifted": "azimuth of samples shifted by ε rad",
    "stray-below": "share ε of samples below the horizon",
    "selection-off": "blend: share ½(1 + ε) in the pdf",
}

FOUND = 0.95
DEFAULT_SAMPLES = 1_000_000  # of ChiSquareTest
# Sizes are 10^(k/steps) for whole k, from 1e-7 to 1.
SMALLEST_DECADE = -7


def found_by_mitsuba(
    child: Child, configuration: Configuration, bug: tuple[str, float], samples: int, seeds: int
) -> int:
    settings = {"sample_count": samples}
    runs, _ = child.ask(mitsuba_request(configuration, range(seeds), threads=1, settings=settings, bug=bug))
    return sum(run["rejected"] for run in runs)


def smallest(
    child: Child, configuration: Configuration, bug: str, samples: int, seeds: int, steps: int
) -> dict[str, Any]:
    """Bisects the grid of sizes. The seeds are the same at each size, so that more is hardly ever found of less."""
    counts: dict[int, int] = {}

    def is_found(k: int) -> bool:
        counts[k] = found_by_mitsuba(child, configuration, (bug, 10 ** (k / steps)), samples, seeds)
        return counts[k] >= ceil(FOUND * seeds)

    low, high = SMALLEST_DECADE * steps, 0
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if is_found(middle) else (middle, high)
    return {
        "bug": bug,
        "configuration": configuration.label,
        "theta": configuration.theta,
        "samples": samples,
        "seeds": seeds,
        "size": 10 ** (high / steps) if high in counts or is_found(high) else None,
        "grid_ratio": 10 ** (1 / steps),
        "found": {f"{10 ** (k / steps):.3g}": n for k, n in sorted(counts.items())},
        "rejected_without_bug": found_by_mitsuba(child, configuration, (bug, 0.0), samples, seeds),
    }


def mitsubas_power(tools: Tools, quick: bool, seeds: int) -> list[dict[str, Any]]:
    """Every graded bug on GGX of alpha 0.1 at 45°, and the missing G1 also at 0.3."""
    at = headline()
    rougher = Configuration(*conductor("ggx", 0.3), 45.0)
    cases = [(at, bug) for bug in GRADED] + [(rougher, "g1-missing")]
    counts = [1 << 20] if quick else [1 << 20, DEFAULT_SAMPLES]
    child = mitsuba_child(tools)
    rows = [smallest(child, c, bug, n, seeds, 8 if quick else 20) for n in counts for c, bug in cases]
    child.end()
    return rows


def smallest_alpha(tools: Tools, samples: int, seeds: int) -> dict[str, Any]:
    """The wrong roughness that ChiSquareTest just finds; on a fine grid, since costs are compared at it."""
    child = mitsuba_child(tools)
    result = smallest(child, headline(), "alpha-off", samples, seeds, 40)
    child.end()
    return result


# gonio's mutants of the same bugs; the blend is another one there, phong's diffuse
# and glossy lobe.
MUTANTS = {
    "pdf-scaled": "pdf-scaled",
    "alpha-off": "pdf-alpha",
    "g1-missing": "pdf-without-g1",
    "azimuth-shifted": "azimuth-shifted",
    "stray-below": "stray-samples",
    "selection-off": "lobe-share-off",
}


def gonios_power(calibration: Path) -> dict[str, dict[str, Any]]:
    """The figures of gonio and of the fixed grids by bug and α, if `gonio calibrate` has
    left any: the smallest sizes found in 95 % of runs, by decision; None where not even
    the largest was.
    """
    if not calibration.exists():
        return {}
    power = json.loads(calibration.read_text()).get("power") or {"curves": []}
    at = {c["mutant"]: c for c in power["curves"] if c["samples"] == 1 << 20}
    found = {}
    for bug, mutant in MUTANTS.items():
        if curve := at.get(f"mutant-{mutant}"):
            alpha = "0.3" if bug == "g1-missing" else "0.1"
            found[f"{bug} {alpha}"] = curve["smallest"]
    return found


def equal_power(tools: Tools, size: float, seeds: int) -> dict[str, Any]:
    """The number of samples at which gonio fails a pdf of alpha (1 + `size`) in 95 % of
    runs: by its own terms, and by Mitsuba's (significance 0.01, no error tolerated).
    """
    terms = {"gonio's terms": Terms(), "mitsuba's terms": MITSUBAS_TERMS}
    child = gonio_child(tools)
    result: dict[str, Any] = {"size": size, "seeds": seeds}
    for name, t in terms.items():
        found: dict[int, int] = {}
        # Blocks of 4096 samples, by steps of √2 or less.
        for samples in (k << e for e in range(12, 20) for k in (2, 3)):
            subject = f"off-alpha:alpha=0.1,error={size}"
            request = gonio_request(subject, 45.0, range(1, seeds + 1), replace(t, samples=samples))
            found[samples] = child.ask(request)[0]["verdicts"].count("fail")
            if found[samples] >= ceil(FOUND * seeds):
                break
        else:
            raise RuntimeError(f"gonio does not find an error of {size} with {found}")
        result[name] = {"samples": samples, "found": found}
    child.end()
    return result
