"""Plays scenes on all cores of this machine, or on those of a Ray cluster."""

import socket
from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from functools import partial

from robustnav_msgs_py.errors import BadParameterError, GraphError
from robustnav_nodes.benchmarks.search_plan import PlayedEpisode, SceneJob, play
from robustnav_nodes.benchmarks.search_suite import NOISY, make_scene
from robustnav_nodes.worker_pool import worker_pool

KNOCK_TIMEOUT_S = 5.0


def play_here(jobs: Sequence[SceneJob], workers: int) -> Iterator[list[PlayedEpisode]]:
    """What each job gave, as they end, from `workers` processes; one worker is this process.

    Raises what `play` raises, and GraphError where a process died.
    """
    if workers == 1:
        warm_up(jobs[0])
        yield from map(play, jobs)
        return
    with worker_pool(min(workers, len(jobs)), partial(warm_up, jobs[0])) as pool:
        running = [pool.submit(play, job) for job in jobs]
        try:
            for done in as_completed(running):
                yield done.result()
        except BrokenProcessPool as error:
            raise GraphError(
                "a worker process died, of too little memory perhaps: run with fewer --workers"
            ) from error


def play_on_ray(jobs: Sequence[SceneJob], address: str) -> Iterator[list[PlayedEpisode]]:
    """What each job gave, as they end, from the Ray cluster at `address` ("auto", "local", "host:port").

    robustnav, and scene files if any, must be where its machines find them too. Raises BadParameterError
    where Ray is not installed or no cluster is there, and what `play` raises.
    """
    try:
        import ray
    except ImportError as error:
        raise BadParameterError(
            "--ray needs Ray, which is not installed here: pip install 'robustnav[cluster]'"
        ) from error
    try:
        _knock(address)
        ray.init(address=address, log_to_driver=False)
    except (OSError, ValueError, RuntimeError) as error:
        raise BadParameterError(
            f"there is no Ray cluster at {address!r} ({error}): start one with 'ray start --head', or name "
            "'local'"
        ) from error
    try:
        played = ray.remote(_play_warm)
        running = [played.remote(job) for job in jobs]
        while running:
            done, running = ray.wait(running)
            try:
                yield ray.get(done[0])
            except ray.exceptions.RayTaskError as error:
                raise error.cause from error
    finally:
        ray.shutdown()


def _knock(address: str) -> None:
    """Raises OSError where nobody answers at "host:port"; Ray itself would try for minutes."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if host and port.isdecimal():
        socket.create_connection((host, int(port)), KNOCK_TIMEOUT_S).close()


def warm_up(job: SceneJob) -> None:
    """Play one small scene with the same planners, so that no decision is timed that compiles."""
    play(replace(job, load=partial(make_scene, "easy", 0), detectors=(NOISY,), numbers=range(1)))


_is_warm = False


def _play_warm(job: SceneJob) -> list[PlayedEpisode]:
    """`play`, in a process that has played before."""
    global _is_warm
    if not _is_warm:
        warm_up(job)
        _is_warm = True
    return play(job)
