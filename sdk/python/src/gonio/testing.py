"""Tests of BSDFs that exist only in the test's process."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterable
from typing import Any, Optional, Union

from . import _verdict
from ._errors import GonioError
from ._local import Local
from ._promises import Claims
from ._promises import claims as checked
from ._subject import ResultError

__all__ = ["assert_valid"]

#: Samples in each direction where nothing else is said: as many as Rust's assert_valid takes.
SAMPLES = 1 << 16


def assert_valid(
    bsdf: object,
    *,
    theta: Union[float, Iterable[float], None] = None,
    samples: Optional[int] = None,
    checks: Union[str, Iterable[str], None] = None,
    seed: Optional[int] = None,
    claims: Optional[Claims] = None,
    timeout: float = 300,
) -> dict[str, Any]:
    """Has gonio measure `bsdf`, an instance with eval, and pdf and sample if it can, or a
    class that needs no arguments. Raises AssertionError with what fails, where it is
    worst, and the cause.

    theta: polar angles of wo in degrees (0, 30, 60, 75, 85, 89, and the back of what has one)
    samples: in each direction at most (65536)
    checks: only these
    seed: of all random numbers; fixed, so that unchanged code cannot flake
    claims: in place of its own
    timeout: seconds that all of it may take

    Gives the report (report.json). The program is $GONIO, or gonio on PATH.
    """
    __tracebackhide__ = True  # pytest shows the test and the message
    instance = bsdf() if isinstance(bsdf, type) else bsdf
    name = type(instance).__name__
    options = ["--samples", str(SAMPLES if samples is None else samples)]
    for angle in [theta] if isinstance(theta, (int, float)) else theta or []:
        options += ["--theta", str(float(angle))]
    for check in [checks] if isinstance(checks, str) else checks or []:
        options += ["--check", check]
    if seed is not None:
        options += ["--seed", str(seed)]
    for key, value in checked(claims or {}, name).items():
        options += ["--claim", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    with Local(instance) as local:
        subject = shlex.join(local.program)
        command = [_gonio(), "check", subject, "--format", "json", "--quiet", *options]
        code, out, err = _run(command, name, timeout)
        failure = local.failure
    report = _report(out)
    if code == 0 and report is not None:
        return report
    # What the user's code raised, with its traceback; pytest shows it.
    cause = None if isinstance(failure, (GonioError, ResultError)) else failure
    said = err.replace(subject, name).strip()
    if code == 2:
        raise ValueError(f"gonio was asked for something that it does not know:\n{said}")
    if code in (1, 3):
        text = _verdict.message(name, report) if report else f"gonio cannot measure {name}:\n{said}"
        # In place of the command that stands for the object.
        raise AssertionError(text.replace(subject, name)) from cause
    if code == 4:
        reasons = _verdict.skipped(report or {})
        raise AssertionError(f"gonio measured nothing of {name}:{reasons or chr(10) + said}") from cause
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    raise RuntimeError(f"gonio ended with {how}, and no report:\n{said or out[-2000:]}") from cause


def _gonio() -> str:
    """The program."""
    named = os.environ.get("GONIO")
    found = shutil.which(named or "gonio")
    if found is not None:
        return found
    what = "gonio is not on PATH, and $GONIO is not set"
    if named:
        what = f"$GONIO is {named!r}, which is no program"
    raise GonioError(
        f"{what}; in gonio's folder, type cargo install --path . (or cargo build --release, and set "
        "GONIO=…/target/release/gonio)"
    )


def _run(command: list[str], name: str, timeout: float) -> tuple[int, str, str]:
    """Exit code, stdout, stderr. All that it started ends with it."""
    own_group = sys.platform != "win32"
    with subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=own_group,
    ) as gonio:
        try:
            out, err = gonio.communicate(timeout=timeout)
        except BaseException as error:
            if own_group:
                os.killpg(gonio.pid, signal.SIGKILL)
            gonio.kill()
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
            err = gonio.communicate()[1].strip()
            raise TimeoutError(
                f"gonio did not end with {name} within {timeout:g} s; give it more timeout=, fewer samples= "
                f"or fewer theta=, or functions over arrays" + (f"\n{err}" if err else "")
            ) from None
    return gonio.returncode, out, err


def _report(out: str) -> Optional[dict[str, Any]]:
    try:
        found = json.loads(out)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None
