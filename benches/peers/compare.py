"""Mitsuba 3's ChiSquareTest and gonio side by side; started by `run`."""

import argparse
import json
import os
import platform
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from children import MITSUBAS_TERMS, Terms, Tools
from configurations import configurations, headline
from cost import costs, target
from false_alarms import false_alarms
from power import DEFAULT_SAMPLES, equal_power, gonios_power, mitsubas_power, smallest_alpha
from tables import markdown

PARTS = ("cost", "false-alarms", "power", "equal-power")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benches/peers/run", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a few configurations, few seeds, coarse grids")
    parser.add_argument("--part", action="append", choices=PARTS, help="only this part (may be repeated); the others stay as they are")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where peers.json and peers.md go (target/peers)")
    parser.add_argument("--repetitions", type=int, metavar="N", help="of each time (5; quick: 3)")
    parser.add_argument("--seeds", type=int, metavar="N", help="of each false-alarm and power figure (40; quick: 20)")
    parser.add_argument("--work", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--programs", type=Path, required=True, help=argparse.SUPPRESS)
    return parser.parse_args()


def main() -> None:
    args = arguments()
    repetitions = args.repetitions or (3 if args.quick else 5)
    seeds = args.seeds or (20 if args.quick else 40)
    out: Path = args.out or args.work
    out.mkdir(parents=True, exist_ok=True)
    home = args.work / "home"
    home.mkdir(parents=True, exist_ok=True)
    tools = Tools(Path(sys.executable), args.programs / "gonio", args.programs / "examples/peers", home)
    parts = args.part or PARTS
    about = {
        "machine": {"processor": processor(), "cores": os.cpu_count(), "python": platform.python_version()},
        "quick": args.quick,
        "repetitions": repetitions,
    }
    result: dict[str, Any] = {**earlier(out, about if args.part else None), **about}

    def tell(what: str) -> None:
        print(f"peers: {what}", file=sys.stderr, flush=True)

    def keep() -> None:
        """After each part, so that a run that is stopped has left something."""
        if "power" in result:
            result["gonios_power"] = gonios_power(Path(__file__).parents[2] / "reports/calibration/calibration.json")
        (out / "peers.json").write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n")
        (out / "peers.md").write_text(markdown(result))

    if "cost" in parts:
        tell("CPU time of each configuration")
        result["cost"] = costs(tools, configurations(args.quick), repetitions)
        keep()
    if "false-alarms" in parts:
        tell("false alarms")
        result["false_alarms"] = false_alarms(tools, configurations(args.quick), seeds)
        keep()
    if "power" in parts:
        tell("power of ChiSquareTest on the graded bugs")
        result["power"] = mitsubas_power(tools, args.quick, seeds)
        keep()
    if "equal-power" in parts:
        tell("samples at equal power, and their CPU time")
        theirs = smallest_alpha(tools, DEFAULT_SAMPLES, seeds)
        equal = equal_power(tools, theirs["size"], seeds)
        terms = {
            "as shipped": Terms(),
            "at equal power": replace(Terms(), samples=equal["gonio's terms"]["samples"]),
            "at equal power and significance": replace(MITSUBAS_TERMS, samples=equal["mitsuba's terms"]["samples"]),
        }
        result["equal_power"] = {"mitsuba": theirs, "gonio": equal}
        result["target"] = target(tools, headline(), terms, 3 * repetitions)
        keep()
    print((out / "peers.md").read_text())


def earlier(out: Path, about: dict[str, Any] | None) -> dict[str, Any]:
    """What `out` has of the other parts, where it was measured alike on such a machine."""
    path = out / "peers.json"
    if about is None or not path.exists():
        return {}
    kept = json.loads(path.read_text())
    return kept if all(kept.get(key) == value for key, value in about.items()) else {}


def processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())


if __name__ == "__main__":
    main()
