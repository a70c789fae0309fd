"""Writes what is generated from the code: the README's tables and the parameter file.

`python -m robustnav_nodes.docs` writes, with `--check` it only says what is out of date (exit code 1).
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import yaml

from robustnav_msgs_py import contract
from robustnav_msgs_py.parameters import ParameterSpec, specs
from robustnav_nodes.graph.one_process import node_class

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
PARAMETER_FILE = ROOT / "robustnav_nodes" / "config" / "robustnav.yaml"


def node_table() -> str:
    """The nodes, what they hear, say and serve, as a Markdown table."""
    rows = ["| node | purpose | hears | says | services |", "|---|---|---|---|---|"]
    for row in contract.NODES:
        hears, serves = contract.heard_by(row.executable), contract.served_by(row.executable)
        # also what needs a package that is not on this machine
        says = [topic for topic in contract.TOPICS if row.executable in topic.speakers]
        cells = (
            f"`{row.package}/{row.executable}`",
            row.purpose,
            _names(hears),
            _names(says),
            _names(serves),
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def topic_table() -> str:
    """The topics, their types and quality of service, as a Markdown table."""
    rows = ["| topic | type | quality of service | meaning |", "|---|---|---|---|"]
    rows += [f"| `{row.name}` | `{row.type}` | {row.qos.name} | {row.meaning} |" for row in contract.TOPICS]
    return "\n".join(rows)


def parameter_file() -> str:
    """Every parameter of every node at its default, with its description, as a ROS parameter file."""
    lines = ["# Every parameter at its default. Generated: `make docs`.", ""]
    for row in contract.NODES:
        lines += [f"/**/{row.executable}:", "  ros__parameters:"]
        for spec in specs(node_class(row.package, row.executable).declaration):
            lines += [f"    # {spec.full_description}", f"    {spec.name}: {_yaml(spec)}"]
        lines.append("")
    return "\n".join(lines)


def generated() -> dict[Path, str]:
    """Every generated file and what it should hold."""
    readme = README.read_text(encoding="utf-8")
    for name, table in (("nodes", node_table()), ("topics", topic_table())):
        readme = _between(readme, name, table)
    return {README: readme, PARAMETER_FILE: parameter_file()}


def main(arguments: list[str]) -> int:
    """Write or check."""
    stale = [
        path
        for path, text in generated().items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    ]
    for path in stale:
        if "--check" in arguments:
            print(f"{path.relative_to(ROOT)} does not agree with the code: make docs")
        else:
            path.write_text(generated()[path], encoding="utf-8")
            print(f"wrote {path.relative_to(ROOT)}")
    return 1 if stale and "--check" in arguments else 0


def _names(rows: Sequence[contract.Topic | contract.Service]) -> str:
    return ", ".join(f"`{row.name}`" for row in rows) or "–"


def _yaml(spec: ParameterSpec) -> str:
    return yaml.safe_dump(spec.default, default_flow_style=True, width=10_000).removesuffix("...\n").strip()


def _between(text: str, name: str, table: str) -> str:
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    head, found, rest = text.partition(begin)
    _, closed, tail = rest.partition(end)
    if not found or not closed:
        raise SystemExit(f"README.md lacks the marks {begin} and {end}")
    return f"{head}{begin}\n{table}\n{end}{tail}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
