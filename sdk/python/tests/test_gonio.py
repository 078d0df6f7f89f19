"""Against the real program, where $GONIO names it."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_assert_valid import Lambert

EXAMPLES = Path(__file__).parents[3] / "examples" / "plugins"

pytestmark = pytest.mark.skipif("GONIO" not in os.environ, reason="$GONIO names no program")


def test_lambert_is_valid(gonio):
    report = gonio.assert_valid(Lambert(0.3), theta=[30, 75])
    assert report["summary"]["passed"] > 10


def test_a_wrong_pdf_is_found_and_named(gonio):
    class Wrong(Lambert):
        def pdf(self, wo, wi):
            return 2 * super().pdf(wo, wi)

    with pytest.raises(AssertionError) as e:
        gonio.assert_valid(Wrong(), theta=60)
    text = str(e.value)
    assert "gonio finds Wrong wrong" in text and "normalization" in text and "[constant-factor]" in text
    assert sys.executable not in text


def test_an_exception_is_shown(gonio):
    class Broken(Lambert):
        def eval(self, wo, wi):
            raise ZeroDivisionError("nothing to divide by")

    with pytest.raises(AssertionError, match=r"error  sanity and \d+ more .*\n.* nothing to divide by") as e:
        gonio.assert_valid(Broken(), theta=60)
    assert isinstance(e.value.__cause__, ZeroDivisionError)


def test_only_eval(gonio):
    class Eval:
        dimensions = 2

        def eval(self, wo, wi):
            return np.where((wo[2] > 0) & (wi[:, 2] > 0), 0.5 / np.pi, 0)

    report = gonio.assert_valid(Eval(), theta=60)
    assert report["summary"]["skipped"] > 5


@pytest.mark.skipif(not EXAMPLES.exists(), reason="the examples are not here")
def test_the_example_is_the_built_in_model():
    example = shlex.join([sys.executable, str(EXAMPLES / "ggx.py")]) + ":alpha=0.1"
    options = ["--reference", "torrance-sparrow:alpha=0.1", "--theta", "75", "--samples", "2^18"]
    command = [os.environ["GONIO"], "check", example, *options, "--format", "json"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr
    verdicts = {r["check"]: r["verdict"] for r in json.loads(done.stdout)["results"]}
    assert verdicts["reference"] == "pass" and verdicts["determinism"] == "pass"
