"""assert_valid and its fixture, against a program that stands in for gonio."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import gonio as package
from gonio.testing import assert_valid

FAKE = Path(__file__).parent / "fake_gonio.py"


class Lambert:
    claims = {"isotropic": True}
    dimensions = 2

    def __init__(self, albedo=0.5):
        self.albedo = albedo

    def eval(self, wo, wi):
        return np.where((wo[2] > 0) & (wi[:, 2] > 0), self.albedo / np.pi, 0)

    def pdf(self, wo, wi):
        return np.maximum(wi[:, 2], 0) / np.pi

    def sample(self, wo, u):
        r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
        wi = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=1)
        return wi, np.full(len(u), self.albedo), wi[:, 2] / np.pi


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """Sets what the stand-in finds."""
    program = tmp_path / "gonio"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{FAKE}" "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("GONIO", str(program))
    return lambda finds: monkeypatch.setenv("FAKE", finds)


def test_a_pass_gives_the_report(fake, gonio):
    captured = []  # An object that no other process can have.

    class Local(Lambert):
        def pdf(self, wo, wi):
            captured.append(len(wi))
            return super().pdf(wo, wi)

    report = gonio.assert_valid(Local(0.3))
    assert captured == [256] and report["results"][0]["verdict"] == "pass"
    assert report["options"]["samples"] == 65536 and report["parallel"] is False


def test_options_are_passed_on(fake):
    options = assert_valid(
        Lambert, theta=[0, 60.5], samples=1000, checks="weight", seed=7,
        claims={"isotropic": False, "eta": 1.5, "rng": "internal"},
    )["options"]  # fmt: skip
    assert options["theta"] == ["0.0", "60.5"] and options["check"] == ["weight"]
    assert (options["samples"], options["seed"]) == (1000, 7)
    assert options["claim"] == ["isotropic=false", "eta=1.5", "rng=internal"]
    assert assert_valid(Lambert, theta=30, checks=["mis", "weight"])["options"]["check"] == ["mis", "weight"]


def test_a_failure_tells_where_and_why(fake):
    fake("fail")
    with pytest.raises(AssertionError) as e:
        assert_valid(Lambert())
    assert (
        str(e.value)
        == """gonio finds Lambert wrong
  fail   goodness-of-fit  θo 60° φo 137°  (and 1 more direction)
         samples are off pdf by 0.4
         worst at θi 36.87° φi 0.0°: expected = 68.0249, observed = NaN
  cause: sample() draws from another density [wrong-density]
  repair: draw r = √u
  since: this holds at 6 of 6 directions
  taken for: lambert
  after the repair: p = 0.52
  more: gonio explain wrong-density"""
    )


def test_an_exception_of_the_object_is_the_cause(fake):
    class Broken(Lambert):
        def sample(self, wo, u):
            raise KeyError("no table")

    with pytest.raises(
        AssertionError, match="error  weight\n +KeyError: 'no table'.*test_assert_valid.py"
    ) as e:
        assert_valid(Broken())
    assert isinstance(e.value.__cause__, KeyError)


def test_wrong_shapes_are_told(fake):
    class Flat(Lambert):
        def sample(self, wo, u):
            return u, u[:, 0], u[:, 0]

    with pytest.raises(AssertionError, match=r"wi of shape \(256, 2\) where \(256, 3\) is expected") as e:
        assert_valid(Flat())
    assert e.value.__cause__ is None


def test_other_ends(fake):
    for finds, kind, told in [
        ("usage", ValueError, "did you mean `weight`"),
        ("nothing", AssertionError, r"measured nothing of Lambert:\n  mis, weight: it has no sample\(\)"),
        ("crash", RuntimeError, "exit code 5, and no report:\nout of luck"),
    ]:
        fake(finds)
        with pytest.raises(kind, match=told):
            assert_valid(Lambert())


def test_time_runs_out(fake):
    fake("hang")
    start = time.monotonic()
    with pytest.raises(
        TimeoutError, match=r"gonio did not end with Lambert within 1.5 s; give it more timeout="
    ):
        assert_valid(Lambert(), timeout=1.5)
    assert time.monotonic() - start < 10


def test_several_processes_are_served(fake):
    fake("twice")
    assert assert_valid(Lambert())["results"]


def test_nothing_is_left_behind(fake, tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    before = threading.active_count()
    assert_valid(Lambert())
    deadline = time.monotonic() + 5
    while threading.active_count() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threading.active_count() <= before
    assert not list(tmp_path.glob("gonio-*"))


def test_without_the_program(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("GONIO", raising=False)
    with pytest.raises(
        package.GonioError, match="not on PATH, and .GONIO is not set; .* cargo install --path"
    ):
        assert_valid(Lambert())
    monkeypatch.setenv("GONIO", "/nowhere/gonio")
    with pytest.raises(package.GonioError, match="GONIO is '/nowhere/gonio', which is no program"):
        assert_valid(Lambert())


def test_without_eval(fake):
    with pytest.raises(package.GonioError, match=r"Empty has no eval\(wo, wi\)"):
        assert_valid(type("Empty", (), {})())


def test_the_fixture_costs_nothing_until_it_is_used(tmp_path):
    (tmp_path / "test_x.py").write_text(
        "import sys\n"
        "def test_not_loaded(): assert 'gonio' not in sys.modules and 'numpy' not in sys.modules\n"
        "def test_fixture(gonio): assert callable(gonio.assert_valid) and 'gonio' in sys.modules\n"
    )
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=tmp_path, env=os.environ)
    assert done.returncode == 0, done.stdout
