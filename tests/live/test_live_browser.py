"""The live page in a browser: what it shows of a test in hand, at two widths, and how it says that the run ended."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from hjcamp.backends.recording import Samples
from hjcamp.live.feed import current_feed
from hjcamp.live.process import LiveAsk, live_page

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
VALVES = {"plant": {"name": "valve_joint"}, "backend": {"name": "simulation"}}


@pytest.mark.skipif(BROWSER is None, reason="no Chromium")
def test_the_page_follows_a_test_to_the_end_of_the_run() -> None:
    api = pytest.importorskip("playwright.sync_api")
    said: list[str] = []
    faults: list[str] = []
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda message: faults.append(message.text))
        with live_page(LiveAsk(0, browser=False), said.append):
            feed = current_feed()
            assert feed is not None
            page.goto(said[0].split()[-1])
            feed.run("valves", Path("runs/x"), {"up__pva": VALVES}, {"up__pva": 2}, {})
            arm = np.linspace(0.0, 350.0, 100)
            columns = {
                "time_s": np.arange(100) * 1e-3,
                "phase": np.full(100, 3.0),
                "arm_deg": arm,
                "pressure1_mpa": arm / 1e3,
            }
            feed.look("up__pva/rep_01", "up__pva")(Samples({**columns, "reference_deg": arm}, 0, 0, 0))
            page.locator("#clock:text-is('0.10 s')").wait_for(timeout=20_000)
            assert page.inner_text("#test") == "up, PVA, repetition 01"
            assert page.inner_text("#state") == "running"
            limit = page.locator(".limit").first
            assert "near" in limit.get_attribute("class")
            assert "closest 10.0" in limit.inner_text()
            page.locator("#plots canvas").nth(1).wait_for(timeout=20_000)
            # what the test does not measure has no panel
            assert page.locator("#plots canvas").count() == 3 and page.locator(".legend:visible").count() == 2
            assert page.inner_text(".legend >> nth=0").startswith("reference 34")
            page.set_viewport_size({"width": 500, "height": 900})
            assert page.evaluate("document.documentElement.scrollWidth") == 500
            feed.ended("up__pva/rep_01", "up__pva", None, None, "a line burst")
            feed.say("stopped", "made safe; hjcamp resume goes on")
        page.locator("#state:text-is('stopped')").wait_for(timeout=20_000)
        assert page.inner_text("#words") == "made safe; hjcamp resume goes on"
        assert "0/2, 1 failed" in page.inner_text("#conditions")
        browser.close()
    assert not faults
