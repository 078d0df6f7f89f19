"""Functions of all sorts, and results that are none."""

import numpy as np
import pytest

import gonio
from gonio import _promises
from gonio._errors import GonioError
from gonio._model import Model
from gonio._subject import ResultError

WO = np.array([0.6, 0.0, 0.8])
WI = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, -0.8], [1.0, 0.0, 0.0]])
U = np.array([[0.1, 0.2, 0.3]] * 4)
N = len(WI)


def subject(eval=None, pdf=None, sample=None, **said):
    functions = {"eval": eval or (lambda wo, wi: wi[:, 2]), "pdf": pdf, "sample": sample}
    methods = {name: staticmethod(f) for name, f in functions.items() if f is not None}
    return Model(type("Mine", (), {**methods, **said})()).create({})[0]


def call(s, name, mode="radiance", wo=WO):
    return dict(s.call(name, mode, wo, U.copy() if name == "sample" else WI.copy()))


def drawn(*more, **said):
    """Flags of samples WI, returned with `more`."""
    s = subject(sample=lambda wo, u: (WI, np.ones(N), np.ones(N), *more), scalar=False, **said)
    return s


def test_flags_that_were_left_out_follow_the_side():
    assert call(drawn(), "sample")["flags"].tolist() == [9, 9, 10, 9]
    assert call(drawn(), "sample", wo=-WO)["flags"].tolist() == [10, 10, 9, 9]
    towards = drawn(conventions={"given": "towards"})
    assert call(towards, "sample", wo=-WO)["flags"].tolist() == [9, 9, 10, 9]
    y_up = drawn(conventions={"up": "y"})
    assert call(y_up, "sample", wo=np.array([0, 1.0, 0]))["flags"].tolist() == [9, 9, 9, 9]
    assert call(y_up, "sample", wo=np.array([0, -1.0, 0]))["flags"].tolist() == [9, 9, 10, 9]


def test_flags_and_masks():
    mask = np.array([True, False, True, False])
    assert call(drawn(5), "sample")["flags"].tolist() == [5] * 4
    assert call(drawn([1, 0, 2, 17]), "sample")["flags"].tolist() == [1, 0, 2, 17]
    assert call(drawn(mask), "sample")["flags"].tolist() == [9, 0, 10, 0]
    assert call(drawn(None, mask), "sample")["flags"].tolist() == [9, 0, 10, 0]
    assert call(drawn(5, mask), "sample")["flags"].tolist() == [5, 0, 5, 0]
    assert call(drawn([[1], [2], [1], [2]], mask), "sample")["flags"].tolist() == [1, 0, 1, 0]
    assert call(drawn(mask, ~mask), "sample")["flags"].tolist() == [0] * 4
    named = subject(sample=lambda wo, u: gonio.Sample(WI, np.ones(N), np.ones(N), valid=mask))
    assert call(named, "sample")["flags"].tolist() == [9, 0, 10, 0]


def test_dtypes_and_shapes_that_are_fine():
    z = WI[:, 2]
    for result in (*map(z.astype, ("f4", "f2", "i4", "u1", "?")), z.tolist(), tuple(z), z.reshape(N, 1)):
        s = subject(eval=lambda wo, wi: result, scalar=False)
        assert call(s, "eval")["f"].shape == (N, 1)
    rgb = subject(eval=lambda wo, wi: wi, channels=["r", "g", "b"], scalar=False)
    assert call(rgb, "eval")["f"].tolist() == WI.tolist()


@pytest.mark.parametrize(
    "name, result, told",
    [
        ("eval", None, "eval() returned f that is None where (4,) is expected; is a `return` missing?"),
        ("eval", 0.3, "eval() returned f of shape () where (4,) or (4, 1) is expected"),
        ("eval", WI, 'shape (4, 3) where (4,) or (4, 1) is expected; channels are declared as channels=["r", '
            '"g", "b"], and there is 1 now'),
        ("eval", WI[:, 2] * 1j, "eval() returned f of complex128 where real numbers of shape (4,) are"),
        ("eval", np.array(["a"] * 4), "eval() returned f of <U1 where real numbers"),
        ("eval", [1, [2, 3], 4, 5], "eval() returned f that is no array where (4,) is expected: "),
        ("pdf", np.ones(3), "pdf() returned a pdf of shape (3,) where (4,) or (4, 1) is expected"),
        ("pdf", np.array([None] * 4), "pdf() returned a pdf of object where real numbers of shape (4,)"),
        ("sample", None, "sample() returned None where (wi, weight, pdf) or (wi, weight, pdf, flags) is"),
        ("sample", WI, "sample() returned an array of shape (4, 3) where (wi, weight, pdf)"),
        ("sample", (WI, WI), "sample() returned 2 values where"),
        ("sample", (WI[:, 2], np.ones(N), np.ones(N)), "returned wi of shape (4,) where (4, 3) is expected"),
        ("sample", (WI.T, np.ones(N), np.ones(N)), "returned wi of shape (3, 4) where (4, 3) is expected"),
        ("sample", (WI, 0.5, np.ones(N)), "returned weight of shape () where (4,) or (4, 1) is expected"),
        ("sample", (WI, np.ones(N), None), "returned pdf that is None where (4,) is expected"),
        ("sample", (WI, np.ones(N), np.ones(N), [1]), "returned flags of shape (1,) where (4,) or (4, 1)"),
        ("sample", (WI, np.ones(N), np.ones(N), 1, [True]), "returned valid of shape (1,) where (4,)"),
    ],
)  # fmt: skip
def test_wrong_results_are_told_precisely(name, result, told):
    s = subject(**{name: lambda wo, rows: result, "scalar": False})
    with pytest.raises(ResultError) as e:
        call(s, name)
    assert told in str(e.value)


def test_nan_is_passed_on():
    s = subject(pdf=lambda wo, wi: np.full(len(wi), np.nan))
    assert np.isnan(call(s, "pdf")["pdf"]).all()


def test_what_is_lacking():
    s = subject()
    assert s.has == ["eval"]
    with pytest.raises(ResultError, match=r"Mine has no sample\(\); it has eval"):
        call(s, "sample")


def test_mode_is_passed_where_it_is_taken():
    class Mode:
        def eval(self, wo, wi, mode):
            return np.full(len(wi), len(mode))

        def pdf(self, wo, wi, *, transport="radiance"):
            return np.full(len(wi), len(transport))

        def sample(self, wo, u):
            return WI[: len(u)], np.ones(len(u)), np.ones(len(u))

    s, _ = Model(Mode).create({})
    assert call(s, "eval", "importance")["f"][0, 0] == len("importance")
    assert call(s, "pdf", "radiance")["pdf"][0] == len("radiance")
    assert len(call(s, "sample", "importance")["pdf"]) == N


class Scalar:
    """One direction at a time."""

    channels = ["a", "b"]

    def eval(self, wo, wi):
        x, _, z = wi
        return (max(z, 0.0), abs(x)) if wo[2] > 0 else (0, 0)

    def pdf(self, wo, wi):
        return max(wi[2], 0) / np.pi

    def sample(self, wo, u):
        if u[0] > 0.5:
            return None
        return [0, u[0], (1 - u[0] ** 2) ** 0.5], (1, 2), 0.5


def test_scalar_functions_are_found_out_and_told_once(capfd):
    for _ in range(2):
        s, _ = Model(Scalar).create({})
        assert s.scalar
        assert call(s, "eval")["f"].tolist() == [[1, 0], [0.8, 0.6], [0, 0], [0, 1]]
        assert call(s, "pdf")["pdf"].ravel() * np.pi == pytest.approx([1, 0.8, 0, 0])
        u = np.array([[0.1, 0], [0.9, 0], [0.3, 0]])
        got = dict(s.call("sample", "radiance", WO, u))
        assert got["flags"].tolist() == [9, 0, 9] and got["weight"].tolist() == [[1, 2], [0, 0], [1, 2]]
        assert got["wi"][2] == pytest.approx([0, 0.3, 0.91**0.5])
    assert capfd.readouterr().err.count("takes one direction at a time") == 1


@pytest.mark.parametrize(
    "returned, flags",
    [
        ((True,), 9),
        ((False,), 0),
        ((5,), 5),
        ((0,), 0),
        ((None, False), 0),
        ((None, True), 9),
        ((17, True), 17),
    ],
)
def test_flags_of_scalar_samples(returned, flags):
    s = subject(eval=lambda wo, wi: 1.0, sample=lambda wo, u: ([0, 0, 1], 1, 1, *returned), scalar=True)
    assert call(s, "sample")["flags"].tolist() == [flags] * N


def test_arrays_are_not_taken_for_scalars():
    # Works for arrays: not asked again. Wrong for both: the arrays are told.
    calls = []
    assert not subject(eval=lambda wo, wi: calls.append(1) or wi[:, 2]).scalar and calls == [1]
    for f in (lambda wo, wi: None, lambda wo, wi: wi[:, 5]):
        assert not subject(eval=f).scalar
    # A constant of eval alone is no reason.
    mixed = subject(eval=lambda wo, wi: 0.3, sample=lambda wo, u: (u * 1.0, u[:, 0], u[:, 0]))
    assert not mixed.scalar


def test_wrong_results_of_scalars():
    for name, result, told in [
        ("eval", [1, 2], "eval() returned a value of shape (2,) where a number is expected"),
        ("pdf", None, "pdf() returned a value that is None where a number is expected"),
        ("sample", ([1, 2], 1, 1), "sample() returned wi of shape (2,) where (3,) is expected"),
        ("sample", 3, "sample() returned a value of type int where (wi, weight, pdf)"),
    ]:
        s = subject(**{name: lambda wo, row: result, "scalar": True})
        with pytest.raises(ResultError) as e:
            call(s, name)
        assert told in str(e.value)


def test_a_frame_of_a_scene_is_told_and_flags_follow_it():
    frame = {"normal": [0.6, 0.0, 0.8], "tangent": [0.0, 1.0, 0.0]}
    told = _promises.conventions({"up": frame}, "Paint")
    assert told == {"up": frame}
    for wrong in ({"normal": [0, 0, 1]}, {"normal": [0, 1], "tangent": [1, 0]}, {"normal": 3, "tangent": 4}, "x"):
        with pytest.raises(GonioError, match="up is"):
            _promises.conventions({"up": wrong}, "Paint")
    # Beside the normal of the frame, and opposite to it.
    wi = np.array([[0.8, 0.0, 0.6], [-0.6, 0.0, -0.8]])
    s = subject(
        sample=lambda wo, u: (wi, np.ones(2), np.ones(2)), scalar=False, conventions={"up": frame}
    )
    flags = dict(s.call("sample", "radiance", np.array([0.6, 0.0, 0.8]), U[:2].copy()))["flags"]
    assert list(np.ravel(flags)) == [gonio.REFLECTION | gonio.GLOSSY, gonio.TRANSMISSION | gonio.GLOSSY]
