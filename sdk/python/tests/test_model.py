"""What is said of classes and instances, and what is refused."""

import dataclasses

import numpy as np
import pytest

import gonio
from gonio._model import DECORATED, Model, models


@pytest.fixture(autouse=True)
def forget():
    before = list(DECORATED)
    yield
    DECORATED[:] = before


class Plain:
    def eval(self, wo, wi):
        return wi[:, 2]


def test_names():
    for name, told in [("Lambert", "lambert"), ("TorranceSparrow", "torrance-sparrow"), ("GGX", "ggx"),
                       ("GGXConductor2", "ggx-conductor2"), ("oren_nayar", "oren-nayar")]:  # fmt: skip
        assert Model(type(name, (Plain,), {})).name == told


def test_everything_that_can_be_said():
    @gonio.bsdf(
        name="mine",
        doc="one line",
        channels=["r", "g"],
        dimensions=4,
        precision="f32",
        claims={"eta": np.float32(1.5), "transmissive": np.bool_(True), "rng": "internal"},
        conventions={"up": "y", "weight": "f"},
    )
    class Mine(Plain):
        def __init__(
            self,
            alpha: float = gonio.number(0.3, 0.001, 1, "roughness", role="roughness"),
            masking: str = gonio.choice(["smith", "v-cavity"], "shadowing"),
            table: str = gonio.file("values"),
            gain: float = 2,
            bounces: int = 3,
            *args,
            side: str = gonio.choice(["front", "back"], default="back"),
            **rest,
        ):
            self.given = (alpha, masking, table, gain, bounces, side)

    told = Model(Mine).description
    assert told == {
        "name": "mine",
        "doc": "one line",
        "channels": ["r", "g"],
        "dimensions": 4,
        "precision": "f32",
        "has": ["eval"],
        "claims": {"eta": 1.5, "transmissive": True, "rng": "internal"},
        "conventions": {"up": "y", "weight": "f"},
        "parameters": [
            {
                "name": "alpha",
                "type": "number",
                "default": 0.3,
                "min": 0.001,
                "max": 1,
                "role": "roughness",
                "doc": "roughness",
            },
            {
                "name": "masking",
                "type": "choice",
                "options": ["smith", "v-cavity"],
                "default": "smith",
                "doc": "shadowing",
            },
            {"name": "table", "type": "file", "doc": "values"},
            {"name": "gain", "type": "number", "default": 2.0, "min": -1e30, "max": 1e30},
            {"name": "bounces", "type": "number", "default": 3, "min": -1e30, "max": 1e30},
            {"name": "side", "type": "choice", "options": ["front", "back"], "default": "back"},
        ],
    }
    # In one's own code defaults are what they look like.
    assert Mine().given == (0.3, "smith", "", 2, 3, "back")
    model = Model(Mine)
    with pytest.raises(gonio.GonioError, match="parameter `table` is None: the path of a file must be given"):
        model.create({})
    with pytest.raises(gonio.GonioError, match="parameter `masking` is 'smit'; did you mean `smith`?"):
        model.create({"table": "x", "masking": "smit"})
    with pytest.raises(gonio.GonioError, match="`bounces` is 2.5 where a whole number is expected"):
        model.create({"table": "x", "bounces": 2.5})


def test_arguments_arrive_as_plain_values():
    @gonio.bsdf
    class Keeps(Plain):
        last = None

        def __init__(self, a: float = gonio.number(0.5), b: str = gonio.choice(["x", "y"]), n: int = 3):
            Keeps.last = (a, b, n)

    Model(Keeps).create({"a": 1, "n": 4.0})
    assert Keeps.last == (1.0, "x", 4)
    assert [type(v) for v in Keeps.last] == [float, str, int]


def test_what_depends_on_parameters():
    @gonio.bsdf(claims={"reciprocal": False, "isotropic": True})
    class Glass(Plain):
        conventions = {"up": "y"}

        def __init__(self, eta: float = 1.5):
            self.eta = eta

        @property
        def channels(self):
            return ["r", "g", "b"]

        def claims(self):
            return {"eta": self.eta, "isotropic": self.eta > 1}

    told = Model(Glass).description
    assert told["claims"] == {"reciprocal": False, "isotropic": True} and "channels" not in told
    assert told["conventions"] == {"up": "y"}
    subject, told = Model(Glass).create({"eta": 1.0})
    assert told["claims"] == {"reciprocal": False, "isotropic": False, "eta": 1.0}
    assert told["channels"] == ["r", "g", "b"] and subject.channels == 3


def test_dataclasses():
    @gonio.bsdf
    @dataclasses.dataclass
    class Data(Plain):
        alpha: float = gonio.number(0.2, 0, 1)

    told = Model(Data).description
    assert told["parameters"][0]["default"] == 0.2 and "doc" not in told


def test_instances_have_no_parameters_and_need_no_decorator():
    class Needs(Plain):
        """what it is

        and more"""

        dimensions = 1

        def __init__(self, table):
            self.table = table

    instance = Needs([1])
    assert Model(instance).description == {
        "name": "needs",
        "doc": "what it is",
        "dimensions": 1,
        "has": ["eval"],
    }
    assert models([instance]).keys() == {"needs"}
    with pytest.raises(
        gonio.GonioError, match="argument `table` of Needs.__init__ has no default; declare it"
    ):
        Model(Needs)


@pytest.mark.parametrize(
    "said, told",
    [
        (
            {"claims": {"isotropc": True}},
            "claims of Wrong: no claim is called 'isotropc'; did you mean `isotropic`?",
        ),
        ({"claims": {"isotropic": "yes"}}, "isotropic is 'yes' where True or False is expected"),
        ({"claims": {"eta": True}}, "eta is True where a number is expected"),
        ({"claims": {"rng": "intern"}}, "rng is 'intern'; did you mean `internal`?"),
        ({"claims": ["isotropic"]}, "is no dict"),
        ({"conventions": {"weight": "f-cos-pdf"}}, "weight is 'f-cos-pdf'; did you mean `f-cos-over-pdf`?"),
        ({"conventions": {"upp": "z"}}, "no convention is called 'upp'; did you mean `up`?"),
        ({"channels": "rgb"}, "channels of Wrong are 'rgb'; write their names"),
        ({"channels": []}, "Wrong has 0 channels; 1 to 16 can be measured"),
        ({"dimensions": 2.5}, "dimensions of Wrong are 2.5"),
        ({"precision": "double"}, "precision of Wrong is 'double'"),
    ],
)
def test_what_is_misspelled_is_told_when_the_class_is_made(said, told):
    with pytest.raises(gonio.GonioError) as e:
        gonio.bsdf(**said)(type("Wrong", (Plain,), {}))
    assert told in str(e.value)


def test_other_mistakes():
    with pytest.raises(gonio.GonioError, match=r"Empty has no eval\(wo, wi\)"):
        gonio.bsdf(type("Empty", (), {}))
    with pytest.raises(
        gonio.GonioError, match=r"number\(2, 0, 1\): the default lies outside of \[min, max\], or"
    ):
        gonio.number(2, 0, 1)
    with pytest.raises(gonio.GonioError, match="role='rough'.*did you mean `roughness`"):
        gonio.number(0.5, 0, 1, role="rough")
    with pytest.raises(gonio.GonioError, match="options are a list of words"):
        gonio.choice("smith")
    with pytest.raises(gonio.GonioError, match="two models are called `plain`"):
        models([Plain, Plain()])

    class Switch(Plain):
        def __init__(self, on=True):
            pass

    with pytest.raises(gonio.GonioError, match=r"has the default True; declare it, as on=gonio.choice"):
        Model(Switch)
