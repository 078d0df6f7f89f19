"""Stands in for gonio: starts the subject, asks it a little, and writes a report.

What it finds is what $FAKE says: pass, fail, error, usage, nothing, crash, hang, twice.
"""

import argparse
import json
import os
import shlex
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from client import Client, Refused  # noqa: E402


def result(subject, check, verdict, message, **more):
    empty = {"wo": None, "effect": None, "worst": None, "reason": None}
    told = {"subject": {"name": subject}, "check": check, "verdict": verdict, "message": message}
    return {**told, **empty, **more}


def main():
    fake = os.environ.get("FAKE", "pass")
    options = argparse.ArgumentParser()
    options.add_argument("command", choices=["check"])
    options.add_argument("subject")
    options.add_argument("--format", required=True, choices=["json"])
    options.add_argument("--quiet", action="store_true")
    for name in ("theta", "check", "claim"):
        options.add_argument(f"--{name}", action="append", default=[])
    options.add_argument("--samples", type=int)
    options.add_argument("--seed", type=int)
    args = options.parse_args()
    if fake == "usage":
        print("error: no check is called so; did you mean `weight`?", file=sys.stderr)
        sys.exit(2)
    if fake == "crash":
        print("out of luck", file=sys.stderr)
        sys.exit(5)
    results, diagnoses, code = [], [], 0
    with Client(shlex.split(args.subject)) as c:
        if fake == "hang":
            time.sleep(60)
        if fake == "twice":
            with Client(shlex.split(args.subject)) as other:
                other.create()
                assert len(other.call("eval", [0, 0, 1], [[0, 0, 1]])["f"]) == 1
        c.create()
        wo, u = [0.6, 0, 0.8], np.random.default_rng(1).random((256, 2))
        try:
            s = c.call("sample", wo, u)
            p = c.call("pdf", wo, s["wi"])["pdf"]
            f = c.call("eval", wo, s["wi"])["f"]
            off = np.max(np.abs(s["weight"] * p[:, None] - f * np.abs(s["wi"][:, 2:])))
            results.append(result(args.subject, "weight", "pass", f"off by {off:.1e}"))
        except Refused as error:
            results.append(result(args.subject, "weight", "error", str(error)))
            code = 3
    if fake == "fail":
        for phi, effect in ((17.0, 0.1), (137.0, 0.4)):
            results.append(
                result(
                    args.subject,
                    "goodness-of-fit",
                    "fail",
                    f"samples are off pdf by {effect}",
                    wo={"theta_deg": 60.0, "phi_deg": phi},
                    effect={"name": "√D", "value": effect, "tolerance": 0.003},
                    worst={"wo": wo, "wi": wo, "values": {"expected": 68.02486, "observed": "NaN"}},
                )
            )
        diagnoses.append(
            {
                "subject": args.subject,
                "cause": "wrong-density",
                "statement": "sample() draws from another density",
                "repair": "draw r = √u",
                "p_after_repair": 0.52,
                "evidence": ["this holds at 6 of 6 directions"],
                "textbook": "lambert",
            }
        )
        code = 1
    if fake == "nothing":
        why = "it has no sample()"
        results = [result(args.subject, c, "skipped", "", reason=why) for c in ("mis", "weight")]
        code = 4
    report = {"schema_version": 1, "results": results, "diagnoses": diagnoses, "options": vars(args)}
    report["parallel"] = c.description.get("parallel", True)
    print(json.dumps(report))
    sys.exit(code)


main()
