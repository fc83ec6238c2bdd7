"""What a piece of work has to compile first, in words."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from hjcamp.campaign.execution.console import can_move
from hjcamp.errors import counted

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

LOOK_EVERY_S = 0.5
NAMED = 2


@dataclass
class Kernels:
    """The kernels that some work needs: what each is in words, its text, and the function that is compiled last.

    What is missing is seen in the cache folder, so that it does not matter which process compiles.
    """

    needed: Mapping[str, tuple[str, str]]
    _seen: list[str] = field(default_factory=list, repr=False)
    _looked_at: float = field(default=float("-inf"), repr=False)

    def missing(self) -> list[str]:
        """Return those that no process has compiled yet; looked up at most twice a second."""
        from hjcamp.model.compile.kernel_cache import is_compiled

        if time.monotonic() - self._looked_at > LOOK_EVERY_S:
            self._seen = [words for words, (text, last) in self.needed.items() if not is_compiled(text, last)]
            self._looked_at = time.monotonic()
        return self._seen

    def words(self) -> str:
        """Return what is compiled and how many are left; empty where nothing is missing."""
        missing = self.missing()
        if not missing:
            return ""
        more = f" and {len(missing) - NAMED} more" if len(missing) > NAMED else ""
        left = f"{len(missing)} of {counted(len(self.needed), 'kernel')} left"
        return f"compiling, once for this model, {left}: {'; '.join(missing[:NAMED])}{more}"


def kernels_of(configs: Iterable[Mapping[str, Any]]) -> Kernels:
    """Return the kernels that the tests of some resolved configurations need; none for a backend that has its own."""
    from hjcamp.backends import kernel_texts

    needed: dict[str, tuple[str, str]] = {}
    for config in configs:
        try:
            found = kernel_texts(config)
        except Exception:
            # What is wrong with a configuration is said by its test, not by a line about waiting.
            continue
        needed |= {words: text for words, text in found.items() if text not in needed.values()}
    return Kernels(needed)


@dataclass
class Doing:
    """What is being done, in words that may change while it is shown."""

    words: str

    def now(self, words: str) -> None:
        """Show these words from now on."""
        self.words = words


@dataclass(frozen=True)
class _Line:
    """What a status line shows: what is compiled as long as something is, then what is being done."""

    kernels: Kernels
    doing: Doing

    def __rich__(self) -> Text:
        from rich.text import Text

        return Text(self.kernels.words() or self.doing.words)


@contextmanager
def status(console: Console, kernels: Kernels, doing: str | Doing) -> Iterator[None]:
    """Say on a terminal what is compiled, then what is done; elsewhere one line where something has to be compiled."""
    if can_move(console):
        with console.status(_Line(kernels, doing if isinstance(doing, Doing) else Doing(doing))):
            yield
        return
    if words := kernels.words():
        console.print(f"  {words}", markup=False, soft_wrap=True)
    yield
