"""A check that has passed is void once anything changes that it rests on; the message says what."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig import check as rig_check
from hjcamp.plants.pump_joint.rig.check_stamp import (
    changes,
    decisive,
    parked_path,
    require_check,
    stamp_path,
    write_stamp,
)
from hjcamp.plants.pump_joint.rig.connection import RigUnavailable
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

PARTS = ("inputs", "outputs", "watchdog", "limits", "sensors")


def leaves(value: Any, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the path of each value."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    else:
        yield path


def changed(config: dict[str, Any], path: tuple[str, ...]) -> dict[str, Any]:
    """Return the configuration with another value at a path."""
    other = copy.deepcopy(config)
    place: Any = other
    for part in path[:-1]:
        place = place[part]
    value = place[path[-1]]
    if isinstance(value, bool) or value is None:
        place[path[-1]] = not value
    else:
        place[path[-1]] = value * 1.0000001 + 1e-9 if isinstance(value, float | int) else f"{value}x"
    return other


def test_every_value_of_wiring_scale_limits_and_watchdog_decides(compose: Any, device: VirtualDevice) -> None:
    config = compose("rig=example_pcie", "rig.interlock=K1")
    write_stamp(config, {})
    assert changes(config) == []
    require_check(config)
    paths = [path for part in PARTS for path in leaves(config["rig"][part], ("rig", part))]
    more = [("rig", "output_timing"), ("rig", "interlock"), ("rig", "return_speed_mm_per_s")]
    more += [("pump", "lead_mm_per_rev"), ("amplifier", "command_deg_per_v")]
    assert len(paths) > 50
    for path in [*paths, *more]:
        found = changes(other := changed(config, path))
        assert found is not None and len(found) == 1, path
        assert found[0].startswith(f"{'.'.join(path)} was "), found
        with pytest.raises(RigUnavailable, match="since the last check " + ".".join(path)):
            require_check(other)
        require_check({**other, "rig": {**other["rig"], "check_required": False}})


def test_a_value_that_was_added_or_taken_away(compose: Any, device: VirtualDevice) -> None:
    config = compose("rig=example_pcie")
    write_stamp(config, {})
    without = copy.deepcopy(config)
    del without["rig"]["limits"]["arm_silent_deg"]
    assert changes(without) == ["rig.limits.arm_silent_deg was 6.0 and is absent"]
    without["rig"]["outputs"]["dither"] = None
    with pytest.raises(RigUnavailable, match=r"rig\.outputs\.dither was absent and is None.* and \d more"):
        require_check(without)


def test_what_no_check_rests_on_may_change(compose: Any, device: VirtualDevice) -> None:
    write_stamp(compose("rig=example_pcie"), {})
    require_check(compose("rig=example_pcie", "controller=ffwd_pid", "trajectory=mixed", "rig.calibration=other"))


def test_only_the_last_check_counts(compose: Any, device: VirtualDevice) -> None:
    first = compose("rig=example_pcie")
    second = compose("rig=example_pcie", "rig.inputs.arm.sign=-1")
    write_stamp(first, {})
    write_stamp(second, {})
    require_check(second)
    with pytest.raises(RigUnavailable, match=r"rig\.inputs\.arm\.sign was -1 and is 1"):
        require_check(first)


def test_a_check_that_cannot_be_kept_moves_nothing(
    compose: Any, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    moved: list[str] = []
    monkeypatch.setattr(rig_check, "open_check", lambda *given: moved.append("moved"))
    for name in ("XDG_STATE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    with pytest.raises(RigUnavailable, match="no home folder to keep a rig's check in: set XDG_STATE_HOME"):
        rig_check.check_rig(compose(), lambda question: True, print)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="file is no folder"):
        rig_check.check_rig(compose(), lambda question: True, print)
    assert not moved


def no_home() -> Path:
    raise RuntimeError("Could not determine home directory.")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"checked": 3}', '{"checked": null, "x": 1}', "\x00"])
def test_a_damaged_note_is_none(compose: Any, device: VirtualDevice, text: str) -> None:
    config = compose("rig=example_pcie")
    path = write_stamp(config, {"devices": "Dev1"})
    assert json.loads(path.read_text())["checked"] == decisive(config)
    path.write_text(text)
    with pytest.raises(RigUnavailable, match="was not checked as it is configured now, so nothing moves"):
        require_check(config)


def test_where_the_pump_was_left_outlives_a_change_of_limits(compose: Any, device: VirtualDevice) -> None:
    one, two = compose("rig=example_pcie"), compose("rig=example_pcie", "rig.limits.pump_travel_mm=5")
    assert parked_path(one) == parked_path(two)
    other = compose("rig=example_pcie", "rig.connection={kind:address,address:'lab:1'}")
    assert parked_path(one) != parked_path(other)
    assert stamp_path(one) != stamp_path(other)
