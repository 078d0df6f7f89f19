"""A value of 0.25 on JSON lines, whose eval does what the first argument says; 42 where it got what it must not get."""
import json
import os
import sys


def reads(path):
    try:
        return len(open(path).read(10)) > 0
    except OSError:
        return False


def writes(path):
    try:
        open(path, "w").write("{}")
        return True
    except OSError:
        return False


def attempts(work):
    try:
        work()
        return True
    except OSError:
        return False


def does(deed):
    if deed == "none":
        return False
    if deed == "honest":
        import ctypes, hashlib, random, tempfile, threading, time  # noqa: E401, F401

        thread = threading.Thread(target=time.time)
        thread.start()
        thread.join()
        with tempfile.TemporaryFile() as file:
            file.write(b"x")
        return os.listdir(".") == []
    if deed == "numpy":
        import numpy

        a = numpy.random.default_rng(1).random((64, 64))
        return not numpy.isfinite(a @ numpy.linalg.inv(a)).all()
    if deed == "rubric":
        return reads("../rubric.toml") or reads(os.path.abspath("../hidden.toml")) or os.path.exists("../neighbour")
    if deed == "results":
        return any(map(writes, ["/autograder/results/results.json", "results.json", "../results.json"]))
    if deed == "walk":
        return any("rubric" in f or "hidden" in f for _, _, names in os.walk("/") for f in names)
    if deed == "fork":
        return attempts(os.fork)
    if deed == "subprocess":
        import subprocess

        return attempts(lambda: subprocess.run(["true"], check=True))
    if deed == "socket":
        import socket

        return attempts(lambda: socket.create_connection(("93.184.216.34", 80), 1))
    if deed == "exec":
        return attempts(lambda: os.execv("/bin/sh", ["sh"]))
    if deed == "environment":
        return any(key.startswith(("GONIO", "SECRET")) for key in os.environ)
    raise ValueError(deed)


def line(object):
    print(json.dumps(object), flush=True)


line({"protocol": 1, "models": [{"name": "hostile", "dimensions": 2, "has": ["eval"]}]})
for text in sys.stdin:
    asked = json.loads(text)
    if asked["call"] == "create":
        line({"handle": 1})
    if asked["call"] == "destroy":
        line({})
    if asked["call"] == "eval":
        got = does(sys.argv[1])
        line({"f": [42 if got else 0.25 for _ in asked["wi"]]})
