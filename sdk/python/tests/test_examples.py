"""examples/plugins/ggx.py, by itself and over the wire."""

import sys
from pathlib import Path

import numpy as np
import pytest
from client import Client

PATH = Path(__file__).parents[3] / "examples" / "plugins" / "ggx.py"

pytestmark = pytest.mark.skipif(not PATH.exists(), reason="the examples are not here")


@pytest.fixture(scope="module")
def ggx():
    sys.path.insert(0, str(PATH.parent))
    import ggx

    return ggx


def angles(theta, phi):
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


@pytest.mark.parametrize("alpha", [0.01, 0.2, 1.0])
@pytest.mark.parametrize("theta", [0.0, 0.5, 1.3, 1.55])
def test_functions_agree(ggx, alpha, theta):
    wo, model = angles(theta, 0.3), ggx.GGX(alpha)
    u = np.random.default_rng(1).random((1000, 2))
    wi, weight, pdf, valid = model.sample(wo, u)
    assert valid.mean() > 0.5
    wi, weight, pdf = wi[valid], weight[valid], pdf[valid]
    assert np.linalg.norm(wi, axis=1) == pytest.approx(1, abs=1e-14)
    assert model.pdf(wo, wi) == pytest.approx(pdf, rel=1e-9)
    assert model.eval(wo, wi) * wi[:, 2] == pytest.approx(weight * pdf, rel=1e-9)
    assert [model.eval(w, wo[None])[0] for w in wi[:20]] == pytest.approx(model.eval(wo, wi[:20]))


def test_loses_what_ggx_is_known_to_lose(ggx):
    """1 − ln 2 is left of single scattering at α = 1 and normal incidence."""
    u = np.stack([(np.arange(100_000) + 0.5) / 100_000, np.full(100_000, 0.3)], axis=1)
    _, weight, _, valid = ggx.GGX(1.0).sample(angles(0, 0), u)
    assert np.where(valid, weight, 0).mean() == pytest.approx(1 - np.log(2), abs=1e-5)


def test_edges_warn_of_nothing(ggx):
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        for wo in ([0, 0, 1], [1, 0, 0], [1, 0, 1e-300], [0.6, 0, -0.8]):
            wi = np.array([[0, 0, 1], [-1, 0, 0], [-1, 0, 1e-300], [0, 0, -1.0]])
            model, wo = ggx.GGX(0.1), np.array(wo, float)
            assert not np.isnan(model.eval(wo, wi)).any() and not np.isnan(model.pdf(wo, wi)).any()
            model.sample(wo, np.array([[0, 0], [1 - 2**-53, 1 - 2**-53]]))


def test_over_the_wire():
    with Client([sys.executable, str(PATH)]) as c:
        c.create(alpha=1.0)
        s = c.call("sample", angles(1.3, 0), np.random.default_rng(1).random((1000, 2)))
        none = s["flags"] == 0
        assert 0 < none.mean() < 0.5 and set(s["flags"][~none]) == {9} and np.all(s["wi"][~none][:, 2] > 0)
        assert c.created["describe"]["claims"] == {"isotropic": True}
        assert c.description["models"][0]["parameters"][0]["role"] == "roughness"
