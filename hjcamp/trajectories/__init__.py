"""Reference motions: one kind is one file of this folder, or of a user's own."""

from hjcamp.trajectories.base import Trajectory
from hjcamp.trajectories.build import build_trajectory, find_kinds

__all__ = ["Trajectory", "build_trajectory", "find_kinds"]
