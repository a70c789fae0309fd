"""`robustnav data`: bring search scenes in from other people's formats, and take them out."""

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.benchmarks.instruction_data_commands import (
    instructions_command,
    r2r_command,
    statistics_command,
)

if TYPE_CHECKING:  # loads numba, which no other command should wait for
    from robustnav_nodes.benchmarks.search_scene import SearchScene

data_app = typer.Typer(help="Build or import data sets.", no_args_is_help=True)
import_app = typer.Typer(help="Bring data in from other formats.", no_args_is_help=True)
export_app = typer.Typer(help="Take data out to other formats.", no_args_is_help=True)
data_app.add_typer(import_app, name="import")
data_app.add_typer(export_app, name="export")

data_app.command("instructions")(instructions_command)
data_app.command("r2r")(r2r_command)
data_app.command("statistics")(statistics_command)

_NAMED = 4  # targets named in a summary
MAX_SEED = 2**31 - 1


class Difficulty(StrEnum):
    """How large a simulated home is."""

    EASY = "easy"
    MEDIUM = "medium"
    HARD = "hard"


SceneFile = Annotated[Path, typer.Option("--out", help="scene file to write (.npz); must not exist")]


@data_app.command("homes")
def homes_command(
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="of the first home")] = 1,
    count: Annotated[int, typer.Option(min=1, max=10_000, help="how many, one seed after the other")] = 1,
    difficulty: Annotated[Difficulty, typer.Option(help="1 room, 3 to 4, 6 to 10")] = Difficulty.MEDIUM,
    rooms: Annotated[int | None, typer.Option(min=1, max=10, help="so many rooms instead")] = None,
    objects: Annotated[int | None, typer.Option(min=4, max=80, help="so many small objects")] = None,
    look_alikes: Annotated[
        str, typer.Option(help="a class of which there are several, hard to tell apart")
    ] = "",
    out: Annotated[Path | None, typer.Option(help="folder for the scene files and the pictures")] = None,
    check: Annotated[
        list[Path] | None, typer.Option(help="instead: a scene file to check (and to draw, with --out)")
    ] = None,
) -> None:
    """Make simulated homes as scene files that can be edited, with pictures; or check one of yours."""
    from robustnav_nodes.benchmarks.home_files import check_homes, make_homes

    say = partial(Console(highlight=False).print, markup=False, soft_wrap=True)
    if check:
        check_homes(check, out, say)
        return
    if out is None:
        raise BadParameterError("--out FOLDER says where the homes go; --check FILE checks one instead")
    make_homes(
        range(seed, seed + count),
        out,
        say,
        difficulty=difficulty.value,
        rooms=rooms,
        objects=objects,
        look_alikes=look_alikes,
    )


@import_app.command("pomp")
def import_pomp_command(
    folder: Annotated[Path, typer.Argument(help="the folder input_pomp_be_pd")],
    out: SceneFile,
    target_id: Annotated[int, typer.Option(min=0, help="the object of its GaussObsvMatrix.txt")],
) -> None:
    """Import a scene of the released POMP-BE-PD planner."""
    from robustnav_nodes.benchmarks.import_pomp import import_pomp

    _write(import_pomp(folder, target_id), out)


@import_app.command("avd")
def import_avd_command(
    folder: Annotated[Path, typer.Argument(help="the folder of a scene, such as Home_001_1")], out: SceneFile
) -> None:
    """Import a scene of the Active Vision Dataset."""
    from robustnav_nodes.benchmarks.import_avd import import_avd

    _write(import_avd(folder), out)


@import_app.command("nav2-map")
def import_nav2_map_command(
    map_file: Annotated[Path, typer.Argument(metavar="MAP.yaml", help="a map as Nav2's map saver writes it")],
    out: SceneFile,
    candidates: Annotated[
        Path | None,
        typer.Option(help="mask (.yaml) of what can hold objects; default: what borders the floor"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="decides what hides where, and the detector's errors")] = 1,
) -> None:
    """Import the map of a real place, and hide things in it: how would a search do there?"""
    import numpy as np

    from robustnav_nodes.benchmarks.search_suite import SPACE, hide_targets
    from robustnav_nodes.search_space.nav2_map import read_nav2_map
    from robustnav_nodes.search_space.space import SearchSpace

    floor_map = read_nav2_map(map_file)
    mask = read_nav2_map(candidates) if candidates is not None else None
    everywhere = SearchSpace.build(floor_map, mask, SPACE)
    inside = everywhere.graph.pose(everywhere.graph.largest_part())
    space = SearchSpace.build(floor_map, mask, SPACE, inside)
    _write(hide_targets(space, map_file.stem, "nav2-map", np.random.default_rng(seed)), out)


@export_app.command("pomp")
def export_pomp_command(
    scene: Annotated[Path, typer.Argument(help="scene file (.npz)")],
    target: Annotated[str, typer.Option(help="label of the target")],
    out: Annotated[Path, typer.Option(help="folder to write; must not exist")],
    detector: Annotated[str, typer.Option(help="whose detections")] = "noisy",
) -> None:
    """Export a scene and one of its targets for the released POMP-BE-PD planner."""
    from robustnav_nodes.benchmarks.export_pomp import TARGET_ID, export_pomp
    from robustnav_nodes.benchmarks.scene_file import read_scene

    read = read_scene(scene)
    export_pomp(read, target, detector, out)
    _say(f"{out}: {summary(read)}; {target} is --target_id={TARGET_ID}")


def summary(scene: "SearchScene") -> str:
    """What a scene holds, in one line: "scene Home_001_1, 1192 poses, 840 candidates, 1 target (jar)"."""
    poses, candidates = len(scene.space.graph), len(scene.space.candidates)
    labels = ", ".join(target.label for target in scene.targets[:_NAMED])
    labels += ", ..." if len(scene.targets) > _NAMED else ""
    return (
        f"scene {scene.name}, {_count(poses, 'pose')}, {_count(candidates, 'candidate')}, "
        f"{_count(len(scene.targets), 'target')} ({labels})"
    )


def _count(count: int, thing: str) -> str:
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _write(scene: "SearchScene", path: Path) -> None:
    from robustnav_nodes.benchmarks.scene_file import write_scene

    write_scene(scene, path)
    _say(f"{path}: {summary(scene)}")


def _say(line: str) -> None:
    Console(highlight=False, soft_wrap=True).print(escape(line))
