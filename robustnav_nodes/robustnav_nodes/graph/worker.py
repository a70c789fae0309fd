"""Long work off the executor's thread, its result back on it."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")


class Worker:
    """Runs one job at a time in a thread of its own; `done` is called in the executor's thread.

    `call_soon` hands a function to the executor's thread (`GraphNode.call_soon`), `guard` runs `done` there
    (the node's guard drops it while the node is inactive). `failed` gets the exception of a job that raised.
    Results of jobs that were still running at `close` are dropped.
    """

    def __init__(
        self,
        call_soon: Callable[[Callable[[], None]], None],
        guard: Callable[[Callable[[], None]], None],
        failed: Callable[[BaseException], None],
    ) -> None:
        self._pool = ThreadPoolExecutor(max_workers=1)
        self._call_soon = call_soon
        self._guard = guard
        self._failed = failed
        self._busy = False
        self._closed = False

    @property
    def busy(self) -> bool:
        """Whether a job runs or its result has not been handed over yet."""
        return self._busy

    def submit(self, job: Callable[[], T], done: Callable[[T], None]) -> None:
        """Start `job`; only when not busy."""
        if self._busy:
            raise RuntimeError("the worker is busy; ask `busy` first")
        self._busy = True
        future = self._pool.submit(job)
        future.add_done_callback(lambda finished: self._call_soon(lambda: self._hand_over(finished, done)))

    def close(self) -> None:
        """Wait for the running job, drop its result."""
        self._closed = True
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _hand_over(self, future: "Future[Any]", done: Callable[[Any], None]) -> None:
        self._busy = False
        if self._closed:
            return
        error = future.exception()
        if error is not None:
            self._failed(error)
        else:
            self._guard(lambda: done(future.result()))
