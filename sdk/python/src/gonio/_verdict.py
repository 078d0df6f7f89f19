"""What a report says, in words for a failing test."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

#: Checks that are told; of the others only the number.
MOST = 8

Json = Mapping[str, Any]


def message(name: str, report: Json) -> str:
    """The failing checks of `report`, and the diagnosis."""
    kinds: dict[str, list[Json]] = {}
    for result in report.get("results", []):
        if result["verdict"] in ("fail", "error"):
            # What a call raises is one thing, whichever checks needed it.
            key = result["check"] if result["verdict"] == "fail" else _first_line(result)
            kinds.setdefault(key, []).append(result)
    lines = [f"gonio finds {name} wrong"]
    for kind in list(kinds.values())[:MOST]:
        lines += _failure(kind)
    if len(kinds) > MOST:
        lines.append(f"  … and {len(kinds) - MOST} more")
    for diagnosis in report.get("diagnoses", []):
        lines += _diagnosis(diagnosis)
    return "\n".join(lines)


def skipped(report: Json) -> str:
    """Why checks were skipped."""
    reasons: dict[str, list[str]] = {}
    for result in report.get("results", []):
        if result["verdict"] == "skipped":
            checks = reasons.setdefault(result.get("reason") or result["message"], [])
            if result["check"] not in checks:
                checks.append(result["check"])
    return "".join(f"\n  {', '.join(checks)}: {reason}" for reason, checks in reasons.items())


def _failure(kind: Sequence[Json]) -> list[str]:
    """What fails in some directions: the one where it is worst."""
    result = max(kind, key=lambda r: _size(r.get("effect")))
    checks = list(dict.fromkeys(r["check"] for r in kind))
    check = checks[0] if len(checks) == 1 else f"{checks[0]} and {len(checks) - 1} more"
    more = len({json.dumps(r.get("wo")) for r in kind}) - 1
    others = f"  (and {more} more direction{'s' if more > 1 else ''})" if more else ""
    wo = result.get("wo")
    where = f"  θo {wo['theta_deg']:g}° φo {wo['phi_deg']:g}°" if wo else ""
    lines = [f"  {result['verdict']:5}  {check}{where}{others}", f"         {_first_line(result)}"]
    if result.get("worst"):
        lines.append(f"         {_worst(result['worst'])}")
    return lines


def _first_line(result: Json) -> str:
    return str(result["message"]).strip().partition("\n")[0]


def _size(effect: Any) -> float:
    """How many times an error is what is tolerated."""
    if not effect:
        return -1.0
    try:
        size = abs(float(effect["value"]) / float(effect["tolerance"]))
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return 0.0
    return math.inf if math.isnan(size) else size


def _worst(place: Json) -> str:
    """Where it is worst, and what was found there."""
    text = "worst"
    if place.get("wi"):
        x, y, z = (float(c) for c in place["wi"])
        theta, phi = math.degrees(math.atan2(math.hypot(x, y), z)), math.degrees(math.atan2(y, x)) % 360
        text += f" at θi {theta:.2f}° φi {phi:.1f}°"
    values = ", ".join(f"{name} = {_figure(value)}" for name, value in place.get("values", {}).items())
    u = ", ".join(_figure(value) for value in place.get("u", []))
    return text + (f": {values}" if values else "") + (f", drawn by u = ({u})" if u else "")


def _figure(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (int, float)) else str(value)


def _diagnosis(found: Json) -> list[str]:
    slug = found.get("cause")
    lines = [f"  cause: {found['statement']}" + (f" [{slug}]" if slug else "")]
    if found.get("repair"):
        lines.append(f"  repair: {found['repair']}")
    lines += [f"  since: {evidence}" for evidence in found.get("evidence", [])]
    if found.get("textbook"):
        lines.append(f"  taken for: {found['textbook']}")
    if found.get("p_after_repair") is not None:
        lines.append(f"  after the repair: p = {_figure(found['p_after_repair'])}")
    if slug:
        lines.append(f"  more: gonio explain {slug}")
    return lines
