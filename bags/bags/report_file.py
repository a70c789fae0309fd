"""Write a report as one page that a browser opens anywhere: it holds everything, and asks for nothing."""

import base64
import hashlib
import html
import json
import math
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from matplotlib.colors import Colormap, to_hex

from bags.report_data import ReportData
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.drawing.colors import (
    BELIEF_COLORS,
    FAINT,
    FALSE_ALARM,
    INK,
    MUTED,
    TARGET,
    TIME_COLORS,
    UNKNOWN,
)

PAGE = files("bags") / "report_page"


def write_report_page(data: ReportData, path: Path) -> None:
    """Write the page, whole or not at all; a file that is there is replaced.

    Raises BadFileError where it cannot be written.
    """
    unfinished = path.with_name(path.name + ".part")
    try:
        unfinished.write_text(report_page(data), encoding="utf-8")
        unfinished.replace(path)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise BadFileError(f"the report cannot be written to {path}: {error.strerror or error}") from error


def report_page(data: ReportData) -> str:
    """The page as text. It may run its own script and use its own style, and load nothing."""
    style, script = _part("style.css"), _part("script.js")
    policy = "; ".join(
        (
            "default-src 'none'",
            "img-src data:",
            f"style-src {_hash(style)}",
            f"script-src {_hash(script)}",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )
    return Template(_part("page.html")).substitute(
        policy=policy,
        title=html.escape(f"{data.title} – {data.source}"),
        style=style,
        script=script,
        data=_json({**asdict(data), "palette": _palette()}),
    )


def _part(name: str) -> str:
    return (PAGE / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _json(content: dict[str, Any]) -> str:
    """JSON in which nothing can end the element that it stands in, whatever people said to the robot."""
    text = json.dumps(_finite(content), allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _finite(value: Any) -> Any:
    """`value` with None for every number that is not finite: JSON has no word for these."""
    if isinstance(value, dict):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _palette() -> dict[str, str | list[str]]:
    return {
        "ink": INK,
        "muted": MUTED,
        "faint": FAINT,
        "unknown": UNKNOWN,
        "false_alarm": FALSE_ALARM,
        "target": TARGET,
        "belief": _scale(BELIEF_COLORS),
        "time": _scale(TIME_COLORS),
    }


def _scale(colors: Colormap) -> list[str]:
    return [to_hex(colors(part)) for part in np.linspace(0.0, 1.0, 256)]
