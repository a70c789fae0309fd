import dataclasses
import subprocess
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.manifest import (
    BackEnd,
    Manifest,
    NamedParameter,
    NodeParameters,
    PackageVersion,
    manifest_from_json,
)
from bags.provenance import checkout_state, manifest_of_this_run
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.parameters import specs
from robustnav_nodes.detection.parameters import DetectionParameters

SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=20)
VALUES = SCALARS | st.lists(SCALARS, max_size=3).map(tuple)
PARAMETERS = st.builds(NamedParameter, name=st.text(max_size=10), value=VALUES)
NODES = st.builds(
    NodeParameters, node=st.text(max_size=10), parameters=st.lists(PARAMETERS, max_size=4).map(tuple)
)
MANIFESTS = st.builds(
    Manifest,
    version=st.text(max_size=10),
    wall_start_ns=st.integers(0, 2**63),
    commit=st.text(max_size=40),
    uncommitted_changes=st.booleans(),
    seed=st.none() | st.integers(),
    scene=st.text(max_size=20),
    sim_start_ns=st.none() | st.integers(),
    platform=st.text(max_size=20),
    packages=st.lists(st.builds(PackageVersion, package=st.text(), version=st.text()), max_size=2).map(tuple),
    nodes=st.lists(NODES, max_size=3).map(tuple),
    silent_nodes=st.lists(st.text(max_size=10), max_size=2).map(tuple),
)


@given(MANIFESTS)
def test_a_manifest_survives_as_json(manifest: Manifest) -> None:
    assert manifest_from_json(manifest.as_json()) == manifest


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"version": "1", "wall_start_ns": "soon"}', "{", "null"])
def test_what_is_no_manifest_is_refused(text: str) -> None:
    with pytest.raises(BadFileError, match="no manifest"):
        manifest_from_json(text)


def test_a_field_of_a_newer_version_is_passed_over(manifest: Manifest) -> None:
    newer = manifest.as_json().removesuffix("}") + ', "mood": "good"}'
    assert manifest_from_json(newer) == manifest


def test_back_ends_are_what_parameters_of_that_name_say(manifest: Manifest) -> None:
    node = NodeParameters(
        node="/dialogue",
        parameters=(
            NamedParameter(name="llm.backend", value="rules"),
            NamedParameter(name="vlm_back_end", value="none"),
            NamedParameter(name="back_end_url", value="x"),
            NamedParameter(name="feedback_end", value="x"),
        ),
    )
    told = dataclasses.replace(manifest, nodes=(node,)).back_ends
    assert told == (
        BackEnd(node="/dialogue", parameter="llm.backend", choice="rules"),
        BackEnd(node="/dialogue", parameter="vlm_back_end", choice="none"),
    )


def test_the_back_end_of_the_detector_is_one() -> None:
    defaults = tuple(NamedParameter(name=row.name, value=row.default) for row in specs(DetectionParameters))
    node = NodeParameters(node="/detection", parameters=defaults)
    told = Manifest(version="0", wall_start_ns=0, nodes=(node,))
    assert told.back_ends_text == f"/detection back_end={DetectionParameters().back_end}"


def test_the_commit_of_a_checkout_is_told_with_whether_files_differ(tmp_path: Path) -> None:
    def git(*arguments: str) -> str:
        identity = ["-c", "user.name=a", "-c", "user.email=a@b.invalid", "-c", "core.hooksPath=/dev/null"]
        done = subprocess.run(
            ["git", "-C", str(tmp_path), *identity, *arguments], check=True, capture_output=True, text=True
        )
        return done.stdout.strip()

    code = tmp_path / "code.py"
    code.write_text("a = 1\n")
    assert checkout_state(code) == ("", False)
    git("init", "--quiet")
    assert checkout_state(code) == ("", False)  # inside a checkout that does not hold it
    git("add", "code.py")
    git("commit", "--quiet", "--no-verify", "-m", "a")
    commit = git("rev-parse", "HEAD")
    assert checkout_state(code) == (commit, False)
    code.write_text("a = 2\n")
    assert checkout_state(code) == (commit, True)


def test_a_run_knows_what_it_runs_on() -> None:
    manifest = manifest_of_this_run(Path(__file__))
    assert "numpy" in [package.package for package in manifest.packages]
    assert "Python" in manifest.platform
    assert manifest.wall_start_ns > 0
