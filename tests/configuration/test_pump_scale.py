"""What follows the chosen pump: the scale of the controllers, the gains, and the virtual rig's drive and limits."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.configuration.search_path import packaged_root
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig.silence import coupling_of

PUMP1 = ("pump=pump1", "amplifier=low_gain")
TABLE_5_2_1 = {"positive": {"kp": 1.05, "ki": 70.0, "kd": 0.015}, "negative": {"kp": 1.4, "ki": 90.0, "kd": 0.018}}


@pytest.mark.parametrize("controller", ["open_loop", "pid", "ffwd_pid"])
@pytest.mark.parametrize(("lines", "scale"), [((), 8.5), (PUMP1, 21.4)])
def test_the_scale_follows_the_pump(composer: Composer, controller: str, lines: tuple[str, ...], scale: float) -> None:
    config = composer.compose([f"controller={controller}", *lines]).config
    assert config["controller"]["scale"] == scale
    # thesis 4.6.1: how far the motor turns for one degree of the arm follows from the bores
    bores = 360.0 / config["pump"]["lead_mm_per_rev"] / coupling_of(config).deg_per_mm
    assert scale == pytest.approx(bores, rel=2e-3)


def test_a_scale_that_is_named_stays(composer: Composer) -> None:
    assert composer.compose([*PUMP1, "controller.scale=1.0"]).config["controller"]["scale"] == 1.0


def test_a_pump_that_says_no_scale_is_told_which_one(tmp_path: Path) -> None:
    (tmp_path / "pump").mkdir()
    lines = (packaged_root() / "conf" / "pump" / "pump2.yaml").read_text(encoding="utf-8").splitlines()
    (tmp_path / "pump" / "mine.yaml").write_text("\n".join(one for one in lines if "arm_scale" not in one))
    composer = Composer(folder=tmp_path)
    with pytest.raises(UsageError, match=r"controller\.scale follows pump\.arm_scale, which the chosen 'pump'"):
        composer.compose(["pump=mine"])
    assert composer.compose(["pump=mine", "controller.scale=8.5"]).config["controller"]["scale"] == 8.5


def test_only_pump1_brings_gains_of_its_own(composer: Composer) -> None:
    own = composer.compose(["pump=pump2"]).config["controller"]
    assert {side: own[side] for side in TABLE_5_2_1} == TABLE_5_2_1
    other = composer.compose([*PUMP1]).config
    assert {side: other["controller"][side] for side in TABLE_5_2_1} == other["pump"]["gains"]
    named = composer.compose([*PUMP1, "controller/gains=simulation"]).config["controller"]
    assert named["positive"]["kp"] == 1.03


def test_drive_and_limits_of_the_virtual_rig_follow_the_pump_and_those_of_a_real_rig_do_not(composer: Composer) -> None:
    def of(*lines: str) -> tuple[float, float]:
        rig = composer.compose(lines).config["rig"]
        return rig["outputs"]["pump"]["v_per_deg"], rig["limits"]["pump_travel_mm"]

    assert of() == of("rig=example_pcie") == of(*PUMP1, "rig=example_pcie") == (0.004, 6.0)
    assert of(*PUMP1) == (0.0016, 15.0)
    assert of(*PUMP1, "rig.limits.pump_travel_mm=9") == (0.0016, 9)
