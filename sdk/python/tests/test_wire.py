"""Both wires, and what must not break them."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from client import Client, Refused, python

README = (Path(__file__).parent.parent / "README.md").read_text()
LAMBERT = re.findall(r"```python\n(.*?)```", README, re.S)[0]
WO = [0.6, 0.0, 0.8]
WI = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, -0.8]]


@pytest.fixture(params=["frames", "json-lines"])
def wire(request):
    return request.param


def test_twenty_lines_of_the_readme(tmp_path, wire):
    with Client(python(tmp_path, LAMBERT), wire) as c:
        assert c.description["protocol"] == 1 and "parallel" not in c.description
        assert c.description["models"] == [
            {
                "name": "lambert",
                "dimensions": 2,
                "has": ["eval", "pdf", "sample"],
                "claims": {"isotropic": True},
                "parameters": [
                    {
                        "name": "albedo",
                        "type": "number",
                        "default": 0.5,
                        "min": 0,
                        "max": 1,
                        "doc": "reflectance",
                    }
                ],
            }
        ]
        c.create(albedo=0.3)
        assert c.call("eval", WO, WI)["f"] == pytest.approx(np.array([[0.3], [0.3], [0]]) / np.pi)
        assert c.call("pdf", WO, WI)["pdf"] == pytest.approx(np.array([1, 0.8, 0]) / np.pi)
        s = c.call("sample", WO, [[0.5, 0.25], [0, 0]])
        assert s["wi"] == pytest.approx(np.array([[0, 0.5**0.5, 0.5**0.5], [0, 0, 1]]))
        assert s["weight"].ravel() == pytest.approx([0.3, 0.3])
        assert s["pdf"] == pytest.approx(s["wi"][:, 2] / np.pi)
        assert s["flags"].tolist() == [9, 9]
        assert c.call("sample", [0, 0.6, -0.8], [[0.5, 0.25]])["flags"].tolist() == [0]
        c.destroy()
        with pytest.raises(Refused, match="pdf: no subject has the handle 1"):
            c.call("pdf", WO, WI)
        c.create()
        assert c.call("eval", WO, WI)["f"][0] == pytest.approx(0.5 / np.pi)
        c.close()
    assert (c.code, c.stderr) == (0, "")


def test_many_rows_and_none(tmp_path, wire):
    with Client(python(tmp_path, LAMBERT), wire) as c:
        c.create()
        u = np.random.default_rng(1).random((20_000 if wire == "json-lines" else 100_000, 2))
        s = c.call("sample", WO, u)
        assert s["wi"][:, 2] == pytest.approx(np.sqrt(1 - u[:, 0]))
        assert c.call("pdf", WO, s["wi"])["pdf"] == pytest.approx(s["pdf"])
        assert len(c.call("pdf", WO, np.empty((0, 3)))["pdf"]) == 0


def test_prints_do_no_harm(tmp_path, wire):
    text = """
import ctypes, os, sys, subprocess
import gonio
print("while it is loaded")

@gonio.bsdf
class Loud:
    def __init__(self): print("in init")
    def eval(self, wo, wi):
        print("a print")
        sys.stdout.write("a write\\n")
        sys.__stdout__.write("the old stdout\\n"); sys.__stdout__.flush()
        os.write(1, b"a descriptor\\n")
        libc = ctypes.CDLL(None); libc.puts(b"from C"); libc.fflush(None)
        subprocess.run([sys.executable, "-c", "print('a child')"])
        assert sys.stdin.read() == ""
        return wi[:, 2]

gonio.serve()
"""
    # What is printed before serve() must not be written before it: Python buffers, unless told not to.
    env = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"}
    with Client(python(tmp_path, text), wire, env={**env, "GONIO_WIRE": wire}) as c:
        c.create()
        for _ in range(3):
            assert c.call("eval", WO, WI)["f"].ravel().tolist() == [1, 0.8, -0.8]
    for told in (
        "while it is",
        "in init",
        "a print",
        "a write",
        "old stdout",
        "descriptor",
        "from C",
        "a child",
    ):
        assert told in c.stderr


def test_an_exception_is_told_with_its_line_and_serving_goes_on(tmp_path, wire):
    text = """
import numpy as np, gonio
def helper(wo):
    raise ZeroDivisionError(f"wo = {wo}")
@gonio.bsdf
class Broken:
    def eval(self, wo, wi): return wi[:, 2]
    def pdf(self, wo, wi):
        return helper(wo)
    def sample(self, wo, u):
        return np.cross(np.zeros(5), u)
gonio.serve()
"""
    with Client(python(tmp_path, text), wire) as c:
        c.create()
        with pytest.raises(Refused) as e:
            c.call("pdf", WO, WI)
        first, _, trace = str(e.value).partition("\n\n")
        assert first == f"ZeroDivisionError: wo = [0.6 0.  0.8] ({tmp_path}/brdf.py, line 4, in helper)"
        assert trace.startswith("Traceback") and "line 9, in pdf" in trace and "gonio/_" not in trace
        # Not the line within numpy.
        with pytest.raises(Refused, match=r"brdf.py, line 11, in sample\)"):
            c.call("sample", WO, [[0.1, 0.2, 0.3]])
        assert c.call("eval", WO, WI)["f"].ravel().tolist() == [1, 0.8, -0.8]


def test_numbers_that_json_lacks(tmp_path, wire):
    text = """
import numpy as np, gonio
@gonio.bsdf
class Odd:
    def eval(self, wo, wi): return np.array([np.nan, np.inf, -np.inf])
    def pdf(self, wo, wi): return wi[:, 0]
gonio.serve()
"""
    with Client(python(tmp_path, text), wire) as c:
        c.create()
        np.testing.assert_array_equal(c.call("eval", WO, WI)["f"].ravel(), [np.nan, np.inf, -np.inf])
        if wire == "json-lines":
            c.send(
                {
                    "call": "pdf",
                    "handle": 1,
                    "wo": WO,
                    "wi": [["NaN", 0, 1], [None, 0, 1], ["-Infinity", 0, 1]],
                }
            )
            assert c.receive()[0]["pdf"] == ["NaN", "NaN", "-Infinity"]


def test_calls_that_nobody_knows(tmp_path, wire):
    with Client(python(tmp_path, LAMBERT), wire) as c:
        for header, told in [
            ({"call": "crate"}, "no call is `crate`; did you mean `create`?"),
            ({"call": "create", "model": "lambrt"}, "no model is called `lambrt`; did you mean `lambert`?"),
            (
                {"call": "create", "model": "lambert", "parameters": {"abledo": 1}},
                "Lambert has no parameter `abledo`; did you mean `albedo`?",
            ),
            (
                {"call": "create", "model": "lambert", "parameters": {"albedo": 1.5}},
                "parameter `albedo` is 1.5, which lies outside of [0, 1]",
            ),
            (
                {"call": "create", "model": "lambert", "parameters": {"albedo": "half"}},
                "parameter `albedo` is 'half' where a number is expected",
            ),
            ({"call": "eval", "handle": 7}, "eval: no subject has the handle 7"),
        ]:
            c.send(header)
            with pytest.raises(Refused) as e:
                c.receive()
            assert str(e.value) == told
        c.create()
        handle = c.created["handle"]
        c.send({"call": "eval", "handle": handle, "mode": "light", "wo": WO, "wi": [], "rows": 0})
        with pytest.raises(Refused, match="eval: no mode is called `light`; there are radiance, importance"):
            c.receive()
        c.send({"call": "eval", "handle": handle, "wo": [1, 2], "wi": [], "rows": 0})
        with pytest.raises(Refused, match=r"eval: wo is \[1, 2\] where three numbers are expected"):
            c.receive()
        with pytest.raises(Refused, match="sample: 3 numbers are no 1 rows of 2"):
            c.call("sample", WO, [[0.1, 0.2, 0.3]])
        c.send({"call": "describe"})
        assert c.receive()[0]["models"] == c.description["models"]
        c.send({"call": "describe", "handle": handle})
        assert c.receive()[0]["claims"] == {"isotropic": True}


@pytest.mark.parametrize(
    "sent, told",
    [
        (b"\xff\xff\xff\xff", "no length of a header"),
        (b"\x05\x00\x00\x00hello", "no header"),
        (b"\x0b\x00\x00\x00" + b'{"bytes":8}' + b"1234", "4 bytes came after a header that announces 8"),
    ],
)
def test_a_broken_wire_ends_with_a_reason(tmp_path, sent, told):
    done = subprocess.run(python(tmp_path, LAMBERT), input=sent, capture_output=True, timeout=20)
    assert done.returncode == 1 and told in done.stderr.decode()


def test_what_cannot_be_served_is_told_at_once(tmp_path):
    nothing = subprocess.run(python(tmp_path, "import gonio; gonio.serve()"), capture_output=True, timeout=20)
    assert nothing.returncode == 1 and b"decorate a class with @gonio.bsdf" in nothing.stderr
    command = python(tmp_path, LAMBERT.replace("serve()", "serve(wire='json')"))
    wrong = subprocess.run(command, capture_output=True, timeout=20)
    assert b"no wire is called 'json'; did you mean `json-lines`?" in wrong.stderr
    assert nothing.stdout == wrong.stdout == b""


def test_relay_without_the_test():
    from gonio import _relay

    command = [sys.executable, "-IS", _relay.__file__, "/nowhere/socket"]
    done = subprocess.run(command, capture_output=True, timeout=20)
    assert done.returncode == 1 and b"cannot be reached at /nowhere/socket" in done.stderr


def test_headers_align_numbers(tmp_path):
    with Client(python(tmp_path, LAMBERT)) as c:
        c.create()
        c.send({"call": "pdf", "handle": 1, "wo": WO, "rows": 1}, np.array(WI[:1]))
        size = int.from_bytes(c.program.stdout.read(4), "little")
        text = c.program.stdout.read(size)
        assert (4 + size) % 8 == 0 and json.loads(text) == {"bytes": 8}
        c.program.stdout.read(8)
