"""A Lambert on the wire that is asked for by its argument `wire`, which misbehaves in eval() as `deed` says."""
import json
import math
import os
import struct
import sys
import time

wire, deed = sys.argv[1:3]
out, inp = sys.stdout.buffer, sys.stdin.buffer


def frame(header, numbers=()):
    body = struct.pack(f"<{len(numbers)}d", *numbers)
    head = json.dumps({**header, "bytes": len(body)}).encode()
    out.write(struct.pack("<I", len(head)) + head + body)
    out.flush()


def line(object):
    out.write(json.dumps(object).encode() + b"\n")
    out.flush()


def asked():
    if wire == "json-lines":
        text = inp.readline()
        return json.loads(text) if text else None
    length = inp.read(4)
    if len(length) < 4:
        return None
    header = json.loads(inp.read(struct.unpack("<I", length)[0]))
    numbers = struct.unpack(f"<{header['bytes'] // 8}d", inp.read(header["bytes"]))
    if header["call"] in ("eval", "pdf"):
        header["wi"] = [numbers[k : k + 3] for k in range(0, len(numbers), 3)]
    if header["call"] == "sample":
        header["u"] = [numbers[k : k + 2] for k in range(0, len(numbers), 2)]
    return header


def answer(columns):
    if wire == "json-lines":
        line(columns)
        return
    flat = []
    for column in columns.values():
        for row in column:
            flat.extend(row if isinstance(row, list) else [row])
    frame({}, flat)


children = []


def misbehave():
    if deed == "late-noise":
        print("debugging…", flush=True)
    if deed == "blank":
        out.write(b"\n" * 300_000)
    if deed == "garbage":
        out.write(bytes(range(250, 256)) * 100)
        out.flush()
    if deed == "hang":
        print("now I think about it", file=sys.stderr, flush=True)
        time.sleep(1000)
    if deed == "raise":
        raise ValueError("no such material")
    if deed == "exit":
        sys.exit(0)
    if deed == "kill":
        os.kill(os.getpid(), 9)
    if deed == "close":
        os.close(0)
        os.close(1)
        time.sleep(1000)
    if deed == "deaf":
        os.close(0)
        time.sleep(1000)
    if deed == "half":
        out.write(struct.pack("<I", 100) + b'{"by')
        out.flush()
        sys.exit(3)
    if deed == "flood":
        while True:
            sys.stderr.write("x" * 1000 + "\n")
    if deed == "children" and not children:
        children.append(True)
        for _ in range(5):
            if os.fork() == 0:
                os.setsid()
                while True:
                    time.sleep(1)


if deed == "silent":
    time.sleep(1000)
if deed == "noise":
    print("Hello, I am a plugin", flush=True)
if deed == "late":
    sys.exit("cannot read the configuration")
hello = {"protocol": 1, "models": [{"name": "hostile", "dimensions": 2}]}
if deed == "claim":
    hello["models"][0]["claims"] = {"isotropik": True}
if deed == "old":
    hello["protocol"] = 7
line(hello) if wire == "json-lines" else frame(hello)
while (q := asked()) is not None:
    call = q["call"]
    if call == "create":
        line({"handle": 1}) if wire == "json-lines" else frame({"handle": 1})
        continue
    if call == "destroy":
        line({}) if wire == "json-lines" else frame({})
        continue
    front = q["wo"][2] > 0
    if call == "eval":
        misbehave()
        f = [0.5 / math.pi if front and w[2] > 0 else 0 for w in q["wi"]]
        if deed == "few":
            f = f[:1]
        if deed == "nan":
            f[-1] = None if wire == "json-lines" else math.nan
        if deed == "refuse":
            line({"error": "wo is too steep"}) if wire == "json-lines" else frame({"error": "wo is too steep"})
            continue
        answer({"f": f})
        if deed == "twice":
            answer({"f": f})
    if call == "pdf":
        answer({"pdf": [w[2] / math.pi if front and w[2] > 0 else 0 for w in q["wi"]]})
    if call == "sample":
        wi = []
        for a, b in q["u"]:
            r, t = math.sqrt(a), 2 * math.pi * b
            wi.append([r * math.cos(t), r * math.sin(t), math.sqrt(1 - a)])
        n = len(wi)
        pdf = [w[2] / math.pi for w in wi]
        answer({"wi": wi, "weight": [[0.5]] * n, "pdf": pdf, "flags": [5 if front else 0] * n})
