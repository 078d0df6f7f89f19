"""CPU time of one test on correct BSDFs: the whole process, and warm within one."""

from typing import Any

from children import (
    FINE,
    Cost,
    Terms,
    Tools,
    gonio_child,
    gonio_request,
    mitsuba_child,
    mitsuba_request,
    whole_gonio,
    whole_mitsuba,
)
from configurations import Configuration


def whole(tools: Tools, configuration: Configuration, terms: Terms, repetitions: int) -> dict[str, Any]:
    """Whole processes in turn."""
    whole_mitsuba(tools, configuration)  # fills Dr.Jit's cache
    theirs, ours = Cost(), Cost()
    for _ in range(repetitions):
        their_answer, seconds = whole_mitsuba(tools, configuration)
        theirs.times.append(seconds)
        our_answer, seconds = whole_gonio(tools, configuration, terms)
        ours.times.append(seconds)
    return {
        "mitsuba_s": theirs.median,
        "gonio_s": ours.median,
        "ratio": theirs.median / ours.median,
        "mitsuba": their_answer,
        "gonio": {key: our_answer[key] for key in ("verdict", "evaluations", "samples", "detection_limit")},
    }


def warm(
    tools: Tools,
    configuration: Configuration,
    terms: Terms,
    repetitions: int,
    settings: dict[str, int] | None = None,
) -> dict[str, Any]:
    """Both processes are up and have run the test before; one thread each, in turn."""
    mitsuba, gonio = mitsuba_child(tools), gonio_child(tools)
    # The same seed: another one would be another kernel to Dr.Jit.
    their_request = mitsuba_request(configuration, [0], threads=1, settings=settings)
    our_request = gonio_request(configuration.gonio, configuration.theta, [1], terms)
    for _ in range(2):
        mitsuba.ask(their_request)
        gonio.ask(our_request)
    theirs, ours = Cost(), Cost()
    for _ in range(repetitions):
        theirs.times.append(mitsuba.ask(their_request)[1])
        ours.times.append(gonio.ask(our_request)[1])
    mitsuba.end()
    gonio.end()
    return {"mitsuba_s": theirs.median, "gonio_s": ours.median, "ratio": theirs.median / ours.median}


def costs(tools: Tools, configurations: list[Configuration], repetitions: int) -> list[dict[str, Any]]:
    """Each configuration, both at their defaults."""
    return [
        {
            "configuration": c.label,
            "theta": c.theta,
            "whole": whole(tools, c, Terms(), repetitions),
            "warm": warm(tools, c, Terms(), repetitions),
        }
        for c in configurations
    ]


# Ways to run one test of Mitsuba's in a process of its own: threads, no cache of
# kernels, settings of the test.
WAYS: dict[str, tuple[int | None, bool, dict[str, int]]] = {
    "kernels cached": (None, False, {}),
    "kernels cached, 1 thread": (1, False, {}),
    "no cache": (None, True, {}),
    "no cache, 1 thread": (1, True, {}),
    "kernels cached, res 201, ires 32": (None, False, FINE),
}


def target(tools: Tools, configuration: Configuration, terms: dict[str, Terms], repetitions: int) -> dict[str, Any]:
    """One configuration closely: all `WAYS` of Mitsuba, and gonio on each of the `terms`."""
    theirs = {way: Cost() for way in WAYS}
    ours = {name: Cost() for name in terms}
    evaluations: dict[str, Any] = {}
    whole_mitsuba(tools, configuration)
    whole_mitsuba(tools, configuration, settings=FINE)
    for _ in range(repetitions):
        for way, options in WAYS.items():
            theirs[way].times.append(whole_mitsuba(tools, configuration, *options)[1])
        for name, t in terms.items():
            answer, seconds = whole_gonio(tools, configuration, t)
            ours[name].times.append(seconds)
            evaluations[name] = answer["evaluations"]
    return {
        "mitsuba": {way: cost.median for way, cost in theirs.items()},
        "gonio": {
            name: {
                "samples": terms[name].samples,
                "false_alarm": terms[name].false_alarm,
                "tolerance": terms[name].tolerance,
                "evaluations": evaluations[name],
                "whole_s": cost.median,
                "warm": warm(tools, configuration, terms[name], repetitions),
                "warm_fine": warm(tools, configuration, terms[name], repetitions, FINE),
            }
            for name, cost in ours.items()
        },
    }
