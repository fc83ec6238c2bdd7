"""Follow measured tests with a model, shared out among the crew: each test is on its own, so that the result is the same."""

from __future__ import annotations

from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.course import Course, Followed
from hjcamp.model.run.simulator import Simulator
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
BEGINS = 2


def follow(model: Simulator, p: Array, course: Course, crew: Crew, tolerance: float) -> Followed:
    """Return what `Simulator.follow` gives for ``course``, its tests followed in as many parts as there are workers."""
    edges = parts(course.restart, crew.workers)
    if len(edges) < 3:
        return model.follow(p, course, tolerance=tolerance)
    start = model.observed(course)

    def one(part: slice) -> Followed:
        return model.follow(p, cut(course, part), model.propagators(start, p), tolerance)

    found = list(crew.together(one, [slice(*pair) for pair in pairwise(edges)]))
    readings, ideal, forces = (
        np.concatenate(column) for column in zip(*((part.readings, part.ideal, part.forces) for part in found), strict=True)
    )
    return Followed(readings, ideal, forces, sum(part.steps for part in found))


def parts(restart: NDArray[np.int64], count: int) -> list[int]:
    """Return the edges of at most ``count`` parts of about equal length, each the beginning of a test."""
    n = len(restart)
    begins = np.append(np.flatnonzero(restart == BEGINS), n)
    wanted = n * np.arange(1, count) / count
    inner = {int(begins[np.argmin(np.abs(begins - place))]) for place in wanted}
    return sorted({0, n} | inner)


def cut(course: Course, part: slice) -> Course:
    """Return a part of a course."""
    columns: dict[str, Any] = {one.name: getattr(course, one.name)[part] for one in fields(course) if one.name != "period"}
    return replace(course, **columns)
