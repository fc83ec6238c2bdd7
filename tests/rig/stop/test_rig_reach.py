"""What wiring or limits cannot reach is refused before anything moves, with the numbers."""

from __future__ import annotations

import re
from math import pi
from typing import Any

import pytest

from hjcamp import cli
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig.reach import check_test, need_of

PUMP1 = ("pump=pump1", "amplifier=low_gain")
OPEN = ("controller=open_loop", "procedure.adjustment.enabled=false")


def test_the_need_by_hand(compose: Any) -> None:
    # thesis 4.6.1: 16.8 deg of arm for 1 mm of slider; 360 deg of motor are 1 mm of the pump
    per_arm = 360.0 / ((6.35 / 4.0) ** 2 * 360.0 / (pi * 6.82))
    # 0.2 MPa between two lines of 0.0257 MPa/mm3: each takes half of it
    offset = 0.5 * 0.2 / 0.0257 / (pi / 4 * 6.35**2) * 360.0
    need = need_of(compose("trajectory=sine_0p5hz"))
    assert need.per_arm == pytest.approx(per_arm, rel=1e-12)
    assert need.motor == pytest.approx((-60.0 * per_arm, 60.0 * per_arm + offset), rel=1e-4)
    assert need_of(compose("trajectory=ramp_neg")).motor[0] == pytest.approx(-119.88 * per_arm - 0.5 * offset, rel=1e-4)
    assert need_of(compose(*OPEN, "controller.scale=2")).motor == pytest.approx((0.0, 2 * 119.88))


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (
            (*PUMP1, "rig=example_pcie"),
            r"'ramp_pos' needs the pump motor at 2680 deg \(7\.44 mm\): 21\.43 deg for each of the 119\.9 deg of the "
            r"reference and 111 deg for the pressure adjustment\. outputs\.pump ends at 2500 deg \(10 V; 10\.72 V needed"
            r"\); limits\.pump_travel_mm stops it at 2160 deg \(6 mm\)\. With this rig the reference may go to about 96 ",
        ),
        (("rig.outputs.pump.v_per_deg=0.01",), r"outputs\.pump ends at 1000 deg \(10 V; 10\.63 V needed\)"),
        (("rig.outputs.pump.v_per_deg=-0.01",), r"ends at 1000 deg \(-10 V; -10\.63 V needed\)"),
        (("trajectory=ramp_neg", "rig.outputs.pump.lowest_v=-1"), r"ends at -250 deg \(-1 V; -4\.17 V needed\)"),
        (("rig.limits.pump_travel_mm=2",), r"stops it at 720 deg \(2 mm\)"),
        ((*OPEN, "trajectory.amplitude_deg=260"), r"2208 deg \(6\.13 mm\): 8\.5 deg for each of the 259\.7"),
        (("trajectory.amplitude_deg=-210",), r"turns the arm to -209\.8 deg, limits\.arm_deg stops it at 200 deg"),
        (("trajectory=hold", "trajectory.angle_deg=60"), r"begins at 60 deg.*tracking_deg stops it at 50 deg"),
        (
            ("controller.dither.amplitude_v=11",),
            r"dither\.amplitude_v=11 needs -11 to 11 V, outputs\.dither gives -10 ",
        ),
        (("procedure.preload_speed_mm_per_s=6",), r"needs -12 to 12 V, outputs\.preload gives -10 to 10 V"),
        (("procedure.preload_mpa=1.4",), r"preload_mpa is 1\.4, limits\.pressure_high_mpa stops it at 1\.3 MPa"),
        (
            ("rig.return_speed_mm_per_s=60", "rig.limits.pump_speed_mm_per_s=50"),
            r"limits\.pump_speed_mm_per_s stops it at 50 mm/s",
        ),
    ],
)
def test_refused(compose: Any, lines: tuple[str, ...], words: str) -> None:
    with pytest.raises(UsageError) as caught:
        check_test(compose(*lines))
    assert re.search(words, str(caught.value)), str(caught.value)


@pytest.mark.parametrize(
    "lines",
    [
        ("trajectory.amplitude_deg=199",),
        ("rig.outputs.pump.v_per_deg=-0.004",),
        (*OPEN, "trajectory=hold", "trajectory.angle_deg=360", "controller.scale=1"),
        (*OPEN, "joint=blocked", "trajectory=triangle", "controller.scale=1"),
        ("joint=blocked", "trajectory=hold"),
        ("rig.return_speed_mm_per_s=null",),
        ("rig.outputs.dither=null", "controller.dither.amplitude_v=11"),  # there is nothing that shakes
        ("rig=example_pxie",),  # a voltage drive has no position to run out of
    ],
)
def test_not_refused(compose: Any, lines: tuple[str, ...]) -> None:
    check_test(compose(*lines))


@pytest.mark.study
def test_every_campaign_can_be_planned_on_the_example_with_the_tightest_limits(composer: Any) -> None:
    others = set()
    for campaign in composer.options("campaign"):
        lines = [f"campaign={campaign}", "backend=nidaqmx", "rig=example_pcie", "repetitions=1"]
        asked = composer.compose(lines)
        try:
            make_plan(asked.config, asked.choices["campaign"], lines, composer)
        except UsageError as refused:
            assert "belongs to pump_joint" in str(refused)
            others.add(campaign)
    assert others == {"previous_joint", "valve_timing", "valve_tuning", "two_pumps"}


def test_the_plan_says_it_and_writes_nothing(device: Any, capsys: pytest.CaptureFixture[str]) -> None:
    lines = ["backend=nidaqmx", "rig=virtual", "rig.outputs.pump.v_per_deg=0.01"]
    assert cli.run(["plan", *lines]) == 2
    assert cli.run(["run", *lines, "run_dir=nothing"]) == 2
    assert "outputs.pump ends at 1000 deg" in capsys.readouterr().err
    from pathlib import Path

    assert not Path("nothing").exists()
