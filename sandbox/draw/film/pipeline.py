"""Two things at once: frames are drawn while those before them are encoded."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

T = TypeVar("T")
WAITING = 8
"""Frames that may wait between the two; more would only cost memory."""


class _Consumer(threading.Thread, Generic[T]):
    def __init__(self, consume: Callable[[T], None]) -> None:
        super().__init__(name="encoder", daemon=True)
        self.waiting: queue.Queue[tuple[T] | None] = queue.Queue(WAITING)
        self.error: BaseException | None = None
        self._consume = consume

    def run(self) -> None:
        while (item := self.waiting.get()) is not None:
            if self.error is not None:
                continue
            try:
                self._consume(item[0])
            except BaseException as error:
                self.error = error


def side_by_side(produce: Iterable[T], consume: Callable[[T], None]) -> None:
    """Run ``produce`` in this thread and ``consume`` each of its items, in order, in another.

    Raises whatever either of them raises; the other one is then stopped.
    """
    consumer = _Consumer(consume)
    consumer.start()
    try:
        for item in produce:
            if consumer.error is not None:
                break
            consumer.waiting.put((item,))
    finally:
        consumer.waiting.put(None)
        consumer.join()
    if consumer.error is not None:
        raise consumer.error
