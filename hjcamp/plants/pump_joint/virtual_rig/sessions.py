"""The tasks of a virtual device's clients: channels, reservations, start and stop."""

from __future__ import annotations

import itertools
import uuid
from dataclasses import dataclass, field

RESERVED = -50103
NO_SUCH_TASK = -200088
NO_SUCH_CHANNEL = -200170
NOT_RUNNING = -200983
DUPLICATE_NAME = -200089
NO_ROOM = -50352
MOST_TASKS, LONGEST_NAME = 64, 256


class DeviceError(Exception):
    """An error code of the driver."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code


@dataclass
class Task:
    """One task: its channels in order, with what is measured at a counter. Who knows ``session`` may use it."""

    name: str
    session: str
    kind: str = ""
    channels: list[str] = field(default_factory=list)
    initial: float = 0.0
    rate: float | None = None
    running: bool = False


class Tasks:
    """All tasks by session. A terminal belongs to the task that named it first until that is cleared.

    The protocol knows a task by the name of its session alone, so one without a name gets a name that nobody guesses:
    only the client that made it can use it.
    """

    def __init__(self) -> None:
        self._tasks: dict[str, Task] = {}
        self._numbers = itertools.count()

    def create(self, name: str) -> Task:
        """Add a task; without a name it gets one."""
        if len(self._tasks) >= MOST_TASKS or len(name) > LONGEST_NAME:
            raise DeviceError(
                NO_ROOM, f"The device keeps {MOST_TASKS} tasks, with names of {LONGEST_NAME} letters, and no more."
            )
        if name in self._tasks:
            raise DeviceError(DUPLICATE_NAME, f"Specified task name '{name}' conflicts with an existing task name.")
        task = Task(name, name) if name else Task(f"_unnamedTask<{next(self._numbers)}>", uuid.uuid4().hex)
        self._tasks[task.session] = task
        return task

    def find(self, session: str) -> Task:
        """Return the task of that session."""
        if session not in self._tasks:
            raise DeviceError(NO_SUCH_TASK, "Task specified is invalid or does not exist.")
        return self._tasks[session]

    def holds(self, session: str) -> bool:
        """Return whether the task of that session is there and has a terminal: who only asks or names is not at work."""
        return bool(session in self._tasks and self._tasks[session].channels)

    def clear(self, session: str) -> Task:
        """Remove a task and give its terminals free."""
        task = self.find(session)
        del self._tasks[session]
        return task

    def add_channel(self, session: str, kind: str, channel: str) -> Task:
        """Add a terminal to a task; one that another task holds is refused, as the driver does."""
        task = self.find(session)
        for other in self._tasks.values():
            if channel in other.channels:
                raise DeviceError(RESERVED, f"The specified resource is reserved: {channel} belongs to task '{other.name}'.")
        task.kind = kind
        task.channels.append(channel)
        return task

    def running(self, session: str, kind: str) -> Task:
        """Return a task that was started; raises the driver's error for another."""
        task = self.find(session)
        if not task.running or task.kind != kind:
            raise DeviceError(NOT_RUNNING, f"Task '{task.name}' is not running.")
        return task
