"""How often each rejects a correct BSDF, over seeds."""

from typing import Any

from children import FINE, Terms, Tools, gonio_child, gonio_request, mitsuba_child, mitsuba_request
from configurations import Configuration


def false_alarms(tools: Tools, configurations: list[Configuration], seeds: int) -> list[dict[str, Any]]:
    """Rejections by configuration, of `seeds` runs each."""
    mitsuba, gonio = mitsuba_child(tools), gonio_child(tools)
    rows = []
    for c in configurations:
        row: dict[str, Any] = {"configuration": c.label, "theta": c.theta, "seeds": seeds}
        for name, settings in (("mitsuba", {}), ("mitsuba_fine", FINE)):
            runs, _ = mitsuba.ask(mitsuba_request(c, range(seeds), threads=1, settings=settings))
            row[name] = {
                "rejected": sum(run["rejected"] for run in runs),
                "mass": runs[0]["mass"],
                "pdf_evaluations": runs[0]["pdf_evaluations"],
            }
        answer, _ = gonio.ask(gonio_request(c.gonio, c.theta, range(1, seeds + 1), Terms()))
        row["gonio"] = {v: answer["verdicts"].count(v) for v in ("fail", "inconclusive", "pass")}
        rows.append(row)
    mitsuba.end()
    gonio.end()
    return rows
