"""The results as Markdown."""

from collections.abc import Iterable, Sequence
from statistics import median
from typing import Any

from power import GRADED


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


def ms(seconds: float) -> str:
    return f"{1e3 * seconds:.1f}"


def ratio(theirs: float, ours: float) -> str:
    return f"{theirs / ours:.2f}"


def cost(rows: list[dict[str, Any]]) -> str:
    def line(row: dict[str, Any]) -> list[Any]:
        whole, warm = row["whole"], row["warm"]
        calls = whole["gonio"]["evaluations"]
        return [
            row["configuration"],
            f"{row['theta']:g}°",
            ms(whole["mitsuba_s"]),
            ms(whole["gonio_s"]),
            f"{whole['ratio']:.2f}",
            ms(warm["mitsuba_s"]),
            ms(warm["gonio_s"]),
            f"{warm['ratio']:.2f}",
            whole["mitsuba"]["samples"],
            whole["mitsuba"]["pdf_evaluations"],
            calls["sample"],
            calls["pdf"],
            calls["eval"],
            "rejects" if whole["mitsuba"]["rejected"] else "accepts",
            whole["gonio"]["verdict"],
        ]

    head = ["BSDF", "θ", "process: Mitsuba ms", "gonio ms", "ratio", "warm: Mitsuba ms", "gonio ms", "ratio"]
    head += ["Mitsuba samples", "pdf", "gonio samples", "pdf", "eval", "Mitsuba", "gonio"]
    middle = [median(row[kind]["ratio"] for row in rows) for kind in ("whole", "warm")]
    return (
        "## CPU time, both at their defaults\n\n"
        "User and system time of all threads. Process: kernels cached on disk, default threads. Warm: one thread. "
        f"Ratios are Mitsuba over gonio; their medians are {middle[0]:.2f} and {middle[1]:.2f}.\n\n"
        + table(head, map(line, rows))
    )


def false_alarms(rows: list[dict[str, Any]]) -> str:
    def line(row: dict[str, Any]) -> list[Any]:
        theirs = [f"{row[key]['rejected']} (∫pdf {row[key]['mass']:.3f})" for key in ("mitsuba", "mitsuba_fine")]
        ours = row["gonio"]
        return [row["configuration"], f"{row['theta']:g}°", row["seeds"], *theirs, ours["fail"], ours["inconclusive"]]

    def most(key: str, verdict: str) -> int:
        return sum(2 * row[key][verdict] > row["seeds"] for row in rows)

    total = sum(row["seeds"] for row in rows)
    counts = {key: sum(row[key]["rejected"] for row in rows) for key in ("mitsuba", "mitsuba_fine")}
    fails = sum(row["gonio"]["fail"] for row in rows)
    return (
        "## False alarms on correct BSDFs\n\n"
        f"{len(rows)} configurations, {total} runs of each. Mitsuba's defaults reject {counts['mitsuba']} runs, and "
        f"{most('mitsuba', 'rejected')} configurations in most runs; with res 201, ires 32 {counts['mitsuba_fine']} "
        f"and {most('mitsuba_fine', 'rejected')} (1 % of runs is nominal). gonio fails {fails} runs; it is inconclusive "
        f"about {most('gonio', 'inconclusive')} configurations in most runs.\n\n"
        + table(["BSDF", "θ", "runs", "Mitsuba", "Mitsuba, fine", "gonio fail", "gonio inconclusive"], map(line, rows))
    )


def power(rows: list[dict[str, Any]], ours: dict[str, dict[str, Any]]) -> str:
    def size(row: dict[str, Any], key: str) -> str:
        """Empty where not measured; sizes end at 1."""
        x = row.get(key, "")
        return "> 1" if x is None else f"{x:.2g}" if x else ""

    def line(row: dict[str, Any]) -> list[Any]:
        alpha = row["configuration"].split("α=")[1]
        gonio = ours.get(f"{row['bug']} {alpha}", {}) if row["samples"] == 1 << 20 else {}
        return [
            GRADED[row["bug"]],
            alpha,
            row["samples"],
            size(row, "size"),
            size(gonio, "strict"),
            size(gonio, "statistical"),
            size(gonio, "any"),
            size(gonio, "nori-grid"),
            size(gonio, "pbrt-grid"),
            f"{row['rejected_without_bug']} of {row['seeds']}",
        ]

    head = ["bug", "α", "samples", "Mitsuba, 1e-2", "gonio, ε = 0, 1e-5", "gonio, statistical fail", "gonio, any fail", "grid of Nori, 1e-2", "grid of pbrt-v4, 1e-2", "Mitsuba without bug"]
    grid = f"Sizes are on a grid of ratio {rows[0]['grid_ratio']:.3f}, {rows[0]['seeds']} seeds a point."
    return (
        "## Smallest error found in 95 % of runs\n\nGGX conductor, θ = 45°. "
        + grid
        + " gonio's figures are those of `gonio calibrate`, where it has been run.\n\n"
        + table(head, [line(row) for row in rows])
    )


def target(result: dict[str, Any]) -> str:
    equal, costs = result["equal_power"], result["target"]
    theirs, ours = costs["mitsuba"], costs["gonio"]
    text = (
        "## Cost at equal power\n\nGGX conductor, α = 0.1, θ = 45°. Mitsuba's defaults find a pdf of α(1 + ε) in 95 % "
        f"of runs from ε = {equal['mitsuba']['size']:.4f} ({equal['mitsuba']['seeds']} seeds). gonio fails it as often at:\n\n"
    )
    rows: list[list[Any]] = []
    for name, found in equal["gonio"].items():
        if isinstance(found, dict):
            counts = ", ".join(f"{n}: {k}" for n, k in found["found"].items())
            rows.append([name, found["samples"], counts])
    text += table(["terms", "samples", f"failed of {equal['gonio']['seeds']}, by samples"], rows) + "\n"
    text += (
        "Whole processes (user and system time of all threads; default threads if not told; Mitsuba over gonio):\n\n"
    )
    head = ["gonio", "samples", "false alarm", "calls of sample", "of pdf", "of eval", "gonio ms"]
    head += [f"Mitsuba, {way}: {ms(seconds)} ms" for way, seconds in theirs.items()]
    rows = []
    for name, o in ours.items():
        calls = o["evaluations"]
        rows.append([name, o["samples"], f"{o['false_alarm']:g}", calls["sample"], calls["pdf"], calls["eval"]])
        rows[-1] += [ms(o["whole_s"]), *(ratio(seconds, o["whole_s"]) for seconds in theirs.values())]
    text += table(head, rows) + "\nWarm, one thread:\n\n"
    head = ["gonio", "gonio ms", "Mitsuba ms", "ratio", "Mitsuba, res 201, ires 32 ms", "ratio"]
    rows = []
    for name, o in ours.items():
        fine = o["warm_fine"]
        rows.append([name, ms(o["warm"]["gonio_s"]), ms(o["warm"]["mitsuba_s"]), f"{o['warm']['ratio']:.2f}"])
        rows[-1] += [ms(fine["mitsuba_s"]), f"{fine['ratio']:.2f}"]
    return text + table(head, rows)


def markdown(result: dict[str, Any]) -> str:
    machine = result["machine"]
    title = "# gonio beside Mitsuba 3.9.1\n\n"
    parts = [title + f"{machine['processor']}, {machine['cores']} cores; each part measured in turn in one run.\n"]
    if "target" in result:
        parts.append(target(result))
    if "power" in result:
        parts.append(power(result["power"], result["gonios_power"]))
    if "false_alarms" in result:
        parts.append(false_alarms(result["false_alarms"]))
    if "cost" in result:
        parts.append(cost(result["cost"]))
    return "\n".join(parts)
