"""Runs suites of clients and counts verdicts, or compares a few with those that are known.

    python verdicts.py --gonio ../../target/release/gonio --out reports mitsuba pyradiance

`run` prepares what this needs.
"""

import argparse
import json
import subprocess
import sys
from collections import Counter, defaultdict
from pathlib import Path

HERE = Path(__file__).resolve().parent
SUITES = HERE / "suites"
VERDICTS = ("pass", "fail", "warn", "inconclusive", "error", "waived", "skipped")
#: Exit codes of a run that took place: all passed, a check failed, a subject broke down.
TOOK_PLACE = (0, 1, 3)


def measure(gonio: str, suite: Path, out: Path) -> dict:
    """The report of a suite."""
    out.mkdir(parents=True, exist_ok=True)
    report = out / "report.json"
    report.unlink(missing_ok=True)
    command = [gonio, "run", suite.name, "--out", str(out), "--plots", "none"]
    run = subprocess.run(command, cwd=suite.parent, capture_output=True, text=True)
    (out / "log.txt").write_text(run.stdout + run.stderr)
    if not report.is_file():
        sys.exit(f"clients: {' '.join(command)} ended with {run.returncode} and no report:\n{run.stderr[-2000:]}")
    if run.returncode not in TOOK_PLACE:
        print(f"note: {' '.join(command)} ended with {run.returncode}; see {out}/log.txt", file=sys.stderr)
    return json.loads(report.read_text())


def label(result: dict) -> str:
    """What a row is called: the client's model with its parameters."""
    subject = result["subject"]
    name = subject if isinstance(subject, str) else subject["name"]
    return name.split("_bsdf.py", 1)[-1].strip(" :'") or name


def count(report: dict) -> None:
    """Prints verdicts by model, and each failure in one line."""
    rows: dict[str, Counter] = defaultdict(Counter)
    for result in report["results"]:
        rows[label(result).split(":")[0].split("=")[0]][result["verdict"]] += 1
    print(f"{'':20}" + "".join(f"{v:>13}" for v in VERDICTS))
    for row, counts in rows.items():
        print(f"{row:20}" + "".join(f"{counts[v]:>13}" for v in VERDICTS))
    whole = sum(rows.values(), Counter())
    print(f"{'all':20}" + "".join(f"{whole[v]:>13}" for v in VERDICTS))
    for result in report["results"]:
        if result["verdict"] in ("fail", "error", "warn"):
            wo = result["wo"]
            where = f" θ {wo['theta_deg']:.0f}°" if wo else ""
            text = " ".join((result.get("message") or result.get("reason") or "").split())
            print(f"  {result['verdict']} {result['check']}  {label(result)}{where}  {text[:140]}")


def compare(report: dict, known: dict) -> int:
    """Whether verdicts are those that docs/field-notes.md explains: 0, or 1."""
    found: dict[str, set] = defaultdict(set)
    broken: dict[str, list] = defaultdict(list)
    for result in report["results"]:
        if result["verdict"] != "skipped":
            found[label(result)].add((result["check"], result["verdict"]))
        if result["verdict"] == "error":
            broken[label(result)].append(result.get("message") or result.get("reason"))
    causes = defaultdict(set)
    for diagnosis in report.get("diagnoses", []):
        causes[label(diagnosis)].add(diagnosis.get("cause"))
    wrong = 0
    for subject, fails in known.items():
        verdicts = found.pop(subject, None)
        if not verdicts:
            print(f"WRONG  {subject}: was not measured")
            wrong += 1
            continue
        failed = {check for check, verdict in verdicts if verdict in ("fail", "error")}
        must, may = set(fails["must"]), set(fails["must"]) | set(fails.get("may", []))
        told = f"fails {', '.join(sorted(failed))}" if failed else "passes"
        told += "".join(f" [{cause}]" for cause in sorted(c for c in causes[subject] if c))
        good = must <= failed <= may and not broken[subject]
        good &= any(verdict == "pass" for _, verdict in verdicts)
        good &= set(fails.get("causes", [])) <= causes[subject]
        if good:
            print(f"ok     {subject}: {told}")
        else:
            wrong += 1
            expected = f"fail {', '.join(sorted(must))}" if must else "pass"
            expected += "".join(f" [{cause}]" for cause in fails.get("causes", []))
            print(f"WRONG  {subject}: {told}; should {expected}", *broken[subject][:1], sep="\n       ")
    for subject in found:
        print(f"WRONG  {subject}: nothing is known of it; add it to suites/known.json")
        wrong += 1
    return int(wrong > 0)


def main() -> int:
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--gonio", required=True)
    arguments.add_argument("--out", required=True, type=Path)
    arguments.add_argument("--test", action="store_true")
    arguments.add_argument("suites", nargs="*")
    given = arguments.parse_args()
    if given.test:
        known = json.loads((SUITES / "known.json").read_text())
        return max(
            compare(measure(given.gonio, SUITES / f"{suite}.toml", given.out / suite), subjects)
            for suite, subjects in known.items()
        )
    for suite in given.suites:
        print(f"\n{suite}", flush=True)
        count(measure(given.gonio, SUITES / f"{suite}.toml", given.out / suite))
    return 0


if __name__ == "__main__":
    sys.exit(main())
