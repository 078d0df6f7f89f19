"""Both sides as child processes, metered by the same clock from outside."""

import json
import os
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

from configurations import PHI, Configuration


@dataclass(frozen=True)
class Tools:
    """Where the programs are."""

    python: Path
    gonio: Path
    gonio_side: Path
    # Holds Dr.Jit's cache of compiled kernels, in place of the user's own.
    home: Path


@dataclass(frozen=True)
class Terms:
    """What gonio is asked for besides the subject and wo; its defaults if left out."""

    samples: int = 1 << 18
    false_alarm: float = 1e-6
    tolerance: float | None = None


# Mitsuba's significance, and no error tolerated (none to speak of: gonio takes no 0).
MITSUBAS_TERMS = Terms(false_alarm=0.01, tolerance=1e-9)

# The finest that one of Mitsuba's tests of these BSDFs asks of ChiSquareTest
# (src/bsdfs/tests/test_rough_dielectric.py at alpha = 0.05): what it takes until correct
# sharp lobes pass.
FINE = {"res": 201, "ires": 32}


@dataclass
class Cost:
    """CPU times of repetitions, in seconds."""

    times: list[float] = field(default_factory=list)

    @property
    def median(self) -> float:
        return median(self.times)


class Child:
    """A process that answers one line with another."""

    def __init__(self, command: Sequence[str | Path], env: dict[str, str] | None = None) -> None:
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={**os.environ, **(env or {})}
        )

    def ask(self, request: dict[str, Any]) -> tuple[Any, float]:
        """The answer, and the CPU time (user and system, all threads) that it took."""
        assert self.process.stdin and self.process.stdout
        before = self.cpu()
        print(json.dumps(request), file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self.process.args!r} ended at {request}")
        return json.loads(line), self.cpu() - before

    def cpu(self) -> float:
        # The clock of another process: what clock_getcpuclockid(3) returns on Linux.
        return time.clock_gettime((~self.process.pid << 3) | 2)

    def end(self) -> float:
        """Ends it; CPU time of its whole life."""
        assert self.process.stdin and self.process.stdout
        self.process.stdin.close()
        self.process.stdout.close()
        return finished(self.process)


def finished(process: subprocess.Popen) -> float:
    """Waits for a process; its CPU time from start to end, in seconds."""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):  # 1: gonio's check failed
        raise RuntimeError(f"{process.args!r} ended with {process.returncode}")
    return usage.ru_utime + usage.ru_stime


def mitsuba_child(tools: Tools, home: Path | None = None) -> Child:
    side = Path(__file__).with_name("mitsuba_side.py")
    return Child([tools.python, side], {"HOME": str(home or tools.home)})


def gonio_child(tools: Tools) -> Child:
    return Child([tools.gonio_side])


def mitsuba_request(
    configuration: Configuration,
    seeds: Sequence[int],
    threads: int | None = None,
    settings: dict[str, int] | None = None,
    bug: tuple[str, float] | None = None,
) -> dict[str, Any]:
    return {
        "bsdf": configuration.mitsuba,
        "theta": configuration.theta,
        "phi": PHI,
        "seeds": list(seeds),
        "threads": threads,
        "settings": settings or {},
        "bug": bug,
    }


def gonio_request(subject: str, theta: float, seeds: Sequence[int], terms: Terms) -> dict[str, Any]:
    return {
        "subject": subject,
        "theta": theta,
        "phi": PHI,
        "samples": terms.samples,
        "false_alarm": terms.false_alarm,
        "tolerance": terms.tolerance,
        "seeds": list(seeds),
    }


def whole_mitsuba(
    tools: Tools,
    configuration: Configuration,
    threads: int | None = None,
    cold: bool = False,
    settings: dict[str, int] | None = None,
) -> tuple[Any, float]:
    """One test in a process of its own; `cold` without kernels from earlier ones."""
    with tempfile.TemporaryDirectory() as empty:
        child = mitsuba_child(tools, Path(empty) if cold else None)
        answer, _ = child.ask(mitsuba_request(configuration, [0], threads, settings))
        return answer[0], child.end()


def whole_gonio(tools: Tools, configuration: Configuration, terms: Terms) -> tuple[Any, float]:
    """`gonio check` of one wo in a process of its own."""
    command = f"check {configuration.gonio} --check goodness-of-fit --format json --quiet".split()
    # Mitsuba's test knows radiance only.
    command += f"--transport radiance --theta {configuration.theta} --phi {PHI}".split()
    command += f"--samples {terms.samples} --false-alarm {terms.false_alarm}".split()
    if terms.tolerance is not None:
        command += f"--tolerance {terms.tolerance}".split()
    process = subprocess.Popen([tools.gonio, *command], stdout=subprocess.PIPE, text=True)
    assert process.stdout
    report = json.load(process.stdout)
    return report["results"][0], finished(process)
