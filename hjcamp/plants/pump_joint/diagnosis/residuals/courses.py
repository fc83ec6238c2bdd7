"""The measured tests as courses that a model follows, in groups of neighbours with the same hardware."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.course import Course
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.signals import PERIOD

Array = NDArray[np.float64]


class Courses:
    """What was measured of all tests (n samples), and parts of it as courses."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence = evidence

    @cached_property
    def groups(self) -> list[tuple[slice, Any]]:
        """Runs of neighbouring tests with the same hardware, as sample ranges."""
        edges, tests = self.evidence.edges, self.evidence.tests
        groups: list[tuple[slice, Any]] = []
        begin = 0
        for index in range(1, len(tests) + 1):
            if index == len(tests) or tests[index].hardware != tests[begin].hardware:
                groups.append((slice(int(edges[begin]), int(edges[index])), tests[begin].hardware))
                begin = index
        return groups

    @cached_property
    def columns(self) -> dict[str, Array]:
        names = ("time", "arm", "pressure1", "pressure2", "pump", "dither", "velocity", "track", "acceleration")
        return {name: self.evidence.joined(name) for name in names}

    @cached_property
    def measured(self) -> Array:
        return np.column_stack([self.columns["arm"], self.columns["pressure1"], self.columns["pressure2"]])

    @cached_property
    def _marks(self) -> dict[str, Any]:
        """Restarts of a course with windows and of one without, and what a course has where nothing differs (n,)."""
        whole = self.evidence.restart
        tests, n = np.where(whole == 2, 2, 0), len(whole)
        return {
            "windows": whole,
            "tests": tests,
            "samples": np.maximum(whole, 1),
            "zeros": np.zeros((n, 1)),
        }

    def course(self, part: slice, driven: Array, observed: Array, restarts: str, scatter: Array | None = None) -> Course:
        """Return a part of all tests as a course that restarts in each of its "windows", "samples" or "tests" alone."""
        columns, marks = self.columns, self._marks
        return Course(
            period=PERIOD,
            restart=marks[restarts][part],
            time=columns["time"][part],
            driven=np.ascontiguousarray(driven),
            observed=np.ascontiguousarray(observed),
            velocity=marks["zeros"][part] if restarts == "tests" else columns["velocity"][part, None],
            given=self._given[part] if scatter is None else self._scattered(scatter)[part],
        )

    @cached_property
    def _given(self) -> Array:
        """The plant's inputs (n, inputs) as they were recorded."""
        return inputs_along(PumpJoint, len(self.columns["time"]), dither=self.columns["dither"])

    def _scattered(self, scatter: Array) -> Array:
        return inputs_along(PumpJoint, len(scatter), dither=self.columns["dither"], friction_scatter=scatter)

    @cached_property
    def plain_states(self) -> list[tuple[Array, Array]]:
        """Observed states (n, 4) and travel (n, 1) of each group of tests as they were read."""
        columns, found = self.columns, []
        for part, hardware in self.groups:
            lead, radius = hardware.values["pump_lead"], hardware.values["pulley_radius"]
            pump, arm = columns["pump"][part] * lead, columns["arm"][part] * radius
            observed = np.column_stack([pump, columns["pressure1"][part], columns["pressure2"][part], arm])
            found.append((observed, columns["track"][part, None]))
        return found

    @cached_property
    def places(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Breakaways, and edges of the tests, of each group, counted from where it begins."""
        events, edges, found = np.asarray(self.evidence.breakaways, dtype=np.int64), self.evidence.edges, []
        for part, _ in self.groups:
            own = events[(events >= part.start) & (events < part.stop)] - part.start
            found.append((own, edges[(edges >= part.start) & (edges <= part.stop)] - part.start))
        return found
