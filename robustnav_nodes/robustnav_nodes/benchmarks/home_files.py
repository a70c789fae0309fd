"""Simulated homes as files: scenes to edit, pictures to look at."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image

from robustnav_msgs_py.errors import BadFileError, BadSceneError

if TYPE_CHECKING:  # the simulator stands on this package
    from sim_bridge.homes.home import Home

PICTURE_PX = 1200
JPEG_QUALITY = 86


def make_homes(
    seeds: Iterable[int],
    folder: Path,
    say: Callable[[str], object],
    *,
    difficulty: str,
    rooms: int | None,
    objects: int | None,
    look_alikes: str,
) -> None:
    """Write home-SEED.yaml and home-SEED.jpg for each seed; `say` gets a line for each.

    Raises BadSceneError where a seed gives no such home, BadFileError where a file exists or the folder
    cannot be written.
    """
    from sim_bridge.homes.build import build_home
    from sim_bridge.homes.generator import generate_scene
    from sim_bridge.homes.rooms.room_programmes import Difficulty
    from sim_bridge.homes.scene_files.scene_file import write_scene

    _make_folder(folder)
    for seed in seeds:
        scene = generate_scene(
            seed, difficulty=Difficulty(difficulty), rooms=rooms, objects=objects, look_alikes=look_alikes
        )
        path = folder / f"{scene.name}.yaml"
        write_scene(scene, path)
        home = build_home(scene)
        _draw(home, path.with_suffix(".jpg"))
        say(f"{path}  {_summary(home)}")


def check_homes(files: Sequence[Path], folder: Path | None, say: Callable[[str], object]) -> None:
    """Read and build each scene file; draw it into `folder` where that is given.

    Raises BadFileError or BadSceneError with what is wrong in the first bad one.
    """
    from sim_bridge.homes.build import build_home
    from sim_bridge.homes.furniture.catalogue import default_style
    from sim_bridge.homes.objects.catalogue import default_look
    from sim_bridge.homes.scene_files.scene_file import read_scene

    if folder is not None:
        _make_folder(folder)
    for path in files:
        try:
            home = build_home(read_scene(path, default_style=default_style, default_look=default_look))
        except BadSceneError as problem:
            told = str(problem) if str(path) in str(problem) else f"{path}: {problem}"
            raise BadSceneError(told) from problem
        say(f"{path}  {_summary(home)}: sound")
        if folder is not None:
            _draw(home, folder / f"{path.stem}.jpg")


def _summary(home: "Home") -> str:
    rooms = ", ".join(room.name for room in home.rooms)
    return f"{len(home.rooms)} rooms ({rooms}), {len(home.furniture)} pieces, {len(home.objects)} objects"


def _draw(home: "Home", path: Path) -> None:
    from sim_bridge.pictures import sheet

    try:
        Image.fromarray(sheet(home, PICTURE_PX)).save(path, quality=JPEG_QUALITY)
    except OSError as error:
        raise BadFileError(f"cannot write the picture {str(path)!r}: {error.strerror or error}") from error


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadFileError(f"cannot make the folder {str(folder)!r}: {error.strerror}") from error
