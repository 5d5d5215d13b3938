"""The session of one page: for each type of request the latest is answered, one at a time."""

import asyncio
from collections.abc import Awaitable, Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from stepwell.studio.aside import (
    LONG,
    OWN,
    WorkerProcess,
    Workers,
    answered,
    broken,
    types,
    typical,
)
from stepwell.studio.ask import View
from stepwell.studio.message import (
    Message,
    Refusal,
    WireError,
    message_of,
    packed,
    parse_failure,
    refusal_message,
)

CANCEL, START = "cancel", "start"
_FAST = "fast"  # the process for all fast requests
Send = Callable[[bytes], Awaitable[None]]  # of the socket


class Waiting:
    """Queue of messages: the newest of each type, in order of waiting time."""

    def __init__(self) -> None:
        self._of: dict[str, Message] = {}
        self._some = asyncio.Event()

    def put(self, message: Message) -> None:
        """Queue a message in place of an older one of its type."""
        self._of[message.type] = message
        self._some.set()

    async def take(self) -> Message:
        """Wait for the next message and return it."""
        await self._some.wait()
        return self._pop(next(iter(self._of)))

    def drop(self, seq: int) -> Message | None:
        """Remove the message with this number from the queue."""
        kind = next((kind for kind, message in self._of.items() if message.seq == seq), None)
        return None if kind is None else self._pop(kind)

    def _pop(self, kind: str) -> Message:
        message = self._of.pop(kind)
        if not self._of:
            self._some.clear()
        return message


class Session:
    """The work for one socket.

    Fast requests are answered by a process with compiled code, and until it is ready in `threads`;
    `start` has the tables of the design given to the command; `workers` are taken over from closed
    pages and left to later ones.
    """

    def __init__(
        self,
        send: Send,
        threads: Executor,
        workers: Workers,
        start: dict[str, Any] | None,
        studies: Path | None = None,
    ):
        self._send, self._threads = send, threads
        self._start, self._studies = start, studies
        self._workers, self._quick = workers, Waiting()
        self._fast = workers.take(_FAST, nice=0)
        # One process per slow type: an inverse design of minutes must not delay a yield.
        self._long = {kind: LongWork(send, workers.take(kind)) for kind in LONG}
        self._types = (*types(), START, CANCEL)

    async def hear(self, text: str) -> None:
        """Queue a message of the page."""
        try:
            message = message_of(text, self._types)._replace(studies=self._studies)
        except WireError as error:
            await self._send(parse_failure(error))
            return
        if message.type == CANCEL:
            await self._cancel(message.seq)
        elif message.type == START:
            view = View({"design": self._start, "title": (self._start or {}).get("title", "")})
            await self._send(packed(START, message.seq, view))
        else:
            lane = self._long.get(message.type)
            (self._quick if lane is None else lane.waiting).put(message)

    async def answer(self) -> None:
        """Answer queued messages until cancelled."""
        # Loading compiled code takes longer than the first answers without it.
        starting = None
        if not self._fast.waits:
            starting = asyncio.create_task(self._fast.run(typical(), lambda _: None))
        try:
            lanes = [lane.answer() for lane in self._long.values()]
            await asyncio.gather(self._answer_quick(starting), *lanes)
        finally:
            if starting is not None:
                starting.cancel()
            self._workers.leave(_FAST, self._fast)
            for kind, lane in self._long.items():
                self._workers.leave(kind, lane.aside)

    async def _answer_quick(self, starting: asyncio.Task[bytes | None] | None) -> None:
        loop = asyncio.get_running_loop()
        while True:
            message = await self._quick.take()
            ready = starting is None or (starting.done() and starting.result() is not None)
            if ready and message.type not in OWN:
                data = await self._fast.run(message, lambda _: None) or broken(message)
            else:
                data = await loop.run_in_executor(self._threads, answered, message)
            await self._send(data)

    async def _cancel(self, seq: int) -> None:
        for lane in self._long.values():
            waiting = lane.waiting.drop(seq)
            if waiting is not None:
                await self._send(_ended(waiting))
            elif lane.running is not None and lane.running.seq == seq:
                lane.aside.end()  # which has the lane answer that it was ended


class LongWork:
    """Slow requests of one type, in a separate process."""

    def __init__(self, send: Send, aside: WorkerProcess):
        self.waiting, self.aside = Waiting(), aside
        self.running: Message | None = None
        self._send = send
        self._told: list[asyncio.Future[None]] = []

    def _tell(self, data: bytes) -> None:
        telling = asyncio.ensure_future(self._send(data))
        # A closed page is detected when receiving; this exception can be ignored.
        telling.add_done_callback(lambda done: done.cancelled() or done.exception())
        self._told.append(telling)

    async def answer(self) -> None:
        """Answer queued messages until cancelled."""
        while True:
            message = self.running = await self.waiting.take()
            self._told.clear()
            data = await self.aside.run(message, self._tell)
            self.running = None
            await asyncio.gather(*self._told)
            await self._send(_ended(message) if data is None else data)


def _ended(message: Message) -> bytes:
    problem = Refusal("", "Ended before it was done.")
    return refusal_message(message.type, message.seq, [problem], ended=True)
