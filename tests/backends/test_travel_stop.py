"""E2: a travel stop can be configured; none by default."""

from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.simulation import run_test


def highest(stop: str) -> float:
    lines = ["controller=open_loop", "trajectory=sine_0p5hz", "procedure.preload_mpa=0.4", f"joint.travel_stop_deg={stop}"]
    columns, _ = run_test(Composer().compose(lines).config, 5)
    return float(columns["arm_deg"].max())


def test_the_arm_stays_within_its_stop() -> None:
    assert highest("null") > 45.0
    assert 30.0 < highest("30.0") < 33.0
