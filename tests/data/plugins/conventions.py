"""A Lambert in the conventions that its first argument names, which it declares if the second is `declared`."""
import json
import math
import sys

follows = dict(word.split("=") for word in sys.argv[1].split(",") if word)
declared = sys.argv[2] == "declared"
weight, up = follows.get("weight", "f-cos-over-pdf"), follows.get("up", "z")
given, failure = follows.get("given", "away"), follows.get("failure", "flags")
# Tangent, the direction at right angles, and normal.
frames = {
    "z": ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    "y": ([1, 0, 0], [0, 0, -1], [0, 1, 0]),
    "scene": ([0, 1, 0], [-0.8, 0, 0.6], [0.6, 0, 0.8]),
}
frame = frames[up]
cos = lambda w: sum(a * b for a, b in zip(frame[2], w))


def line(object):
    print(json.dumps(object), flush=True)


model = {"name": "lambert", "dimensions": 2, "claims": {"isotropic": True}}
if declared:
    model["conventions"] = dict(follows)
    if up == "scene":
        model["conventions"]["up"] = {"normal": frame[2], "tangent": frame[0]}
line({"protocol": 1, "models": [model]})
for text in sys.stdin:
    q = json.loads(text)
    if q["call"] == "create":
        line({"handle": 1})
        continue
    if q["call"] == "destroy":
        line({})
        continue
    # A tenth of the draws is absorbed.
    front = (cos(q["wo"]) > 0) == (given == "away")
    pdf = lambda w: 0.9 * max(cos(w), 0) / math.pi if front else 0
    value = lambda w: 0.45 / math.pi if front and cos(w) > 0 else 0
    if q["call"] == "eval":
        line({"f": [value(w) for w in q["wi"]]})
    if q["call"] == "pdf":
        line({"pdf": [pdf(w) for w in q["wi"]]})
    if q["call"] == "sample":
        out = {"wi": [], "weight": [], "pdf": [], "flags": []}
        for a, b in q["u"]:
            absorbed = b > 0.9 or not front
            r, phi, z = math.sqrt(a), 2 * math.pi * b / 0.9, math.sqrt(1 - a)
            x, y = r * math.cos(phi), r * math.sin(phi)
            wi = [x * t + y * s + z * n for t, s, n in zip(*frame)]
            p, f = pdf(wi), value(wi)
            weights = {"f-cos-over-pdf": f * z / (p or 1), "f-over-pdf": f / (p or 1), "f-cos": f * z, "f": f}
            out["wi"].append(wi)
            out["weight"].append(0 if absorbed else weights[weight])
            out["pdf"].append(0 if absorbed else p)
            out["flags"].append(0 if absorbed and failure == "flags" else 5)
        line(out)
