"""A Lambert of another kind: `eval-only`, `internal` (random numbers of its own), `stochastic` (a noisy eval), `f32`, `unimplemented`."""
import json
import math
import random
import struct
import sys

kind = sys.argv[1]
own = random.Random(7)


def line(object):
    print(json.dumps(object), flush=True)


def rounded(x):
    return struct.unpack("f", struct.pack("f", x))[0] if kind == "f32" else x


model = {"name": "lambert", "dimensions": 2, "claims": {"isotropic": True}}
if kind == "eval-only":
    model["has"] = ["eval"]
if kind == "internal":
    model["dimensions"] = 0
    model["claims"] = {"rng": "internal"}
if kind == "stochastic":
    model["claims"] = {"stochastic": True}
if kind == "f32":
    model["precision"] = "f32"
line({"protocol": 1, "models": [model]})
for text in sys.stdin:
    q = json.loads(text)
    front = q.get("wo", [0, 0, 0])[2] > 0
    if q["call"] == "create":
        line({"handle": 1})
    if q["call"] == "destroy":
        line({})
    if q["call"] == "eval":
        noise = lambda: own.uniform(0.5, 1.5) if kind == "stochastic" else 1
        line({"f": [rounded(0.5 / math.pi) * noise() if front and w[2] > 0 else 0 for w in q["wi"]]})
    if q["call"] == "pdf":
        there = front and kind != "unimplemented"
        line({"pdf": [rounded(w[2] / math.pi) if there and w[2] > 0 else 0 for w in q["wi"]]})
    if q["call"] == "sample":
        wi = []
        for u in q["u"]:
            a, b = u if u else (own.random(), own.random())
            r, t = math.sqrt(a), 2 * math.pi * b
            wi.append([rounded(r * math.cos(t)), rounded(r * math.sin(t)), rounded(math.sqrt(1 - a))])
        n = len(wi)
        flag = 5 if front and kind != "unimplemented" else 0
        pdf = [rounded(w[2] / math.pi) for w in wi]
        line({"wi": wi, "weight": [[0.5]] * n, "pdf": pdf, "flags": [flag] * n})
