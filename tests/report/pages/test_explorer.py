"""The explorer: what its points hold, any plant's channels, and in a browser: clicks, keys, zoom, deep links, no network."""

from __future__ import annotations

import base64
import shutil
import zlib
from collections.abc import Iterator
from importlib import resources
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import numpy as np
import polars
import pytest

from hjcamp.errors import UsageError
from hjcamp.report.pages.discrepancy_page import discrepancy_page, picture, table_of
from hjcamp.report.pages.exploration import MOST, Exploration, references
from hjcamp.report.pages.explorer import explorer_html
from hjcamp.report.wording.channels import described

TIME = np.arange(1000) * 1e-3
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def decoded(shown: Exploration, test: int, channel: str, model: int) -> np.ndarray:
    """Return the points of one curve as the page decodes them."""
    head, packed = shown.head(), zlib.decompress(base64.b64decode(shown.points()))
    one = head["tests"][test]
    curve = next(found for found in one["curves"] if found["channel"] == channel and found["model"] == model)
    steps = np.cumsum(np.frombuffer(packed, "<u2")[curve["at"] : curve["at"] + one["points"]].astype(np.int64)) & 0xFFFF
    return np.where(steps == 0, np.nan, curve["low"] + (steps - 1.0) * curve["per"])


def cart(tests: int = 3) -> Exploration:
    """Return tests of a plant with a position in m and a force in N, two models and one that is off at first."""
    shown = Exploration(tests, ["first", "second", "without drag"], {"position_m": 0.01}, ["without drag"])
    for number in range(tests):
        position = np.sin(2 * np.pi * TIME) + 0.01 * number
        models = {"first": {"position_m": position + 0.1 * (number + 1)}, "second": {"position_m": position - 0.02}}
        models["without drag"] = {"position_m": position}
        shown.add(f"sweep/{number + 1}", "sweep", TIME, {"position_m": position, "force_n": np.cos(TIME)}, models)
    return shown


def test_points_come_back_to_a_sixteen_bit_step() -> None:
    shown = cart()
    # in the unit of tables: points, errors and floors alike
    expected = 1e3 * (np.sin(2 * np.pi * TIME) + 0.1)
    assert np.abs(decoded(shown, 0, "position_m", 0) - expected).max() <= 2e3 / 65534
    assert shown.head()["tests"][1]["rms"][0]["position_m"] == pytest.approx(200.0)
    assert shown.head()["floors"]["position_m"] == pytest.approx(10.0)
    assert [one["unit"] for one in shown.head()["channels"]] == ["mm", "N"]


def test_long_tests_are_averaged_and_gaps_stay_gaps() -> None:
    shown = Exploration(1, [])
    values = np.repeat([1.0, 3.0], 5 * MOST)
    values[:20] = np.nan
    shown.add("a", "a", np.arange(len(values)) * 1e-3, {"level_v": values})
    found = decoded(shown, 0, "level_v", -1)
    assert shown.head()["averaged"] == 10 * MOST / len(found) and len(found) <= MOST
    assert np.isnan(found[0]) and found[10] == pytest.approx(1.0) and found[-1] == pytest.approx(3.0)


def test_what_cannot_be_shown_is_refused() -> None:
    shown = Exploration(1, [])
    with pytest.raises(UsageError, match="channel arm_deg has 3 values, time has 1000"):
        shown.add("a", "a", TIME, {"arm_deg": np.zeros(3)})
    with pytest.raises(UsageError, match="unit at the end"):
        described("position", "a plant")
    assert explorer_html(Exploration(1, [])) == ""


def test_a_reference_belongs_to_its_channel() -> None:
    one = np.zeros(2)
    assert list(references({"reference_deg": one, "arm_deg": one, "pump_deg": one})) == ["arm_deg"]
    assert list(references({"reference_b_m": one, "a_m": one, "b_m": one})) == ["b_m"]


def test_names_cannot_leave_their_place() -> None:
    shown = Exploration(1, ["</script><b>"])
    shown.add("</script>", "x", TIME, {"a_m": TIME}, {"</script><b>": {"a_m": TIME}})
    text = explorer_html(shown)
    assert "</script><b>" not in text and text.count("</script>") == text.count("<script")


def test_a_page_carries_uplot_with_its_licence() -> None:
    text = explorer_html(cart())
    licence = (resources.files("hjcamp.report") / "uplot" / "LICENSE").read_text(encoding="utf-8")
    assert "Copyright (c)" in licence and text.count(licence) == 2  # before the style and before the script
    assert text.index(licence, text.index("<script>")) < text.index("var uPlot=")
    assert (distribution("hjcamp").metadata.get_all("License-File") or [])[-1:] == ["hjcamp/report/uplot/LICENSE"]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Give a browser's page; skipped where there is no Chromium or no playwright (extra browser)."""
    api = pytest.importorskip("playwright.sync_api")
    if BROWSER is None:
        pytest.skip("no Chromium")
    file = tmp_path_factory.mktemp("page") / "index.html"
    file.write_text(discrepancy_page("Cart", "", [explorer_html(cart())]), encoding="utf-8")
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        opened = browser.new_page(viewport={"width": 1400, "height": 1000})
        opened.asked, opened.faults, opened.file = [], [], file.as_uri()
        opened.on("request", lambda request: opened.asked.append(request.url))
        opened.on("pageerror", lambda error: opened.faults.append(str(error)))
        yield opened
        browser.close()


def address(page: Any) -> str:
    return str(page.evaluate("decodeURIComponent(location.hash.replaceAll('+', ' '))"))


def open_at(page: Any, hash_: str = "") -> None:
    page.goto("about:blank")
    page.goto(page.file + hash_)
    page.wait_for_selector("#explorer[data-ready]", timeout=20_000)


def test_clicks_and_keys_change_what_is_shown(page: Any) -> None:
    open_at(page)
    page.click("tbody tr:nth-child(2)")
    assert page.inner_text(".now") == "sweep/2" and "test=sweep/2" in address(page)
    page.keyboard.press("ArrowRight")
    assert page.inner_text(".now") == "sweep/3"
    page.click("th:nth-child(2)")  # largest error of the first model on top
    assert page.inner_text("tbody tr:first-child td") == "sweep/3"
    page.click("button[data-of=first]")
    assert page.get_attribute("button[data-of=first]", "aria-pressed") == "false" and "off=without drag|first" in address(page)
    page.click("button[data-channel=force_n]")
    assert page.locator(".plots canvas").count() == 2
    assert not page.faults


def test_a_drag_zooms_every_plot_and_a_deep_link_leads_back(page: Any) -> None:
    open_at(page)
    box = page.locator(".u-over").first.bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.25, box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.5, box["y"] + 40, steps=4)
    page.mouse.up()
    zoomed = address(page)
    parts = dict(part.split("=") for part in zoomed.lstrip("#").split("&"))
    assert float(parts["from"]) == pytest.approx(0.25, abs=0.02) and float(parts["to"]) == pytest.approx(0.5, abs=0.02)
    open_at(page, "#test=sweep%2F3&from=0.1&to=0.2&off=second")
    assert page.inner_text(".now") == "sweep/3"
    assert page.get_attribute("button[data-of=second]", "aria-pressed") == "false"
    assert "from=0.1&to=0.2" in address(page)
    page.keyboard.press("0")
    assert "from" not in address(page)


def click_at(page: Any, seconds: float, plot: int = 0) -> None:
    box = page.locator(".u-over").nth(plot).bounding_box()
    page.mouse.click(box["x"] + box["width"] * seconds / TIME[-1], box["y"] + 30)


def test_two_cursors_say_what_the_points_between_them_do(page: Any) -> None:
    open_at(page, "#test=sweep%2F2&off=second|without drag")
    assert page.locator(".between td").count() == 0
    click_at(page, 0.6)
    click_at(page, 0.2)
    parts = dict(part.split("=") for part in address(page).lstrip("#").split("&"))
    assert float(parts["a"]) == pytest.approx(0.6, abs=0.01) and float(parts["b"]) == pytest.approx(0.2, abs=0.01)
    a, b = (round(1e3 * float(parts[name])) for name in "ab")
    shown = cart()
    seen, first = (decoded(shown, 1, "position_m", model) for model in (-1, 0))
    curves = {".between >> nth=0": (seen, first), ".between >> nth=1": (first - seen,)}
    for place, columns in curves.items():
        rows = page.locator(f"{place} >> tbody tr").all()
        assert len(rows) == len(columns)
        for row, values in zip(rows, columns, strict=True):
            part = polars.Series(values)[b : a + 1]
            expected = {
                "a": values[a],
                "b": values[b],
                "difference": values[b] - values[a],
                "slope": (values[b] - values[a]) / (TIME[b] - TIME[a]),
                "mean": part.mean(),
                "rms": (part**2).mean() ** 0.5,
            }
            for name, value in expected.items():
                assert float(row.locator(f"[data-of={name}]").get_attribute("data-value")) == pytest.approx(
                    value, rel=1e-9, abs=1e-9
                )
    # a third click moves the nearer one; a link leads back; Escape takes both away
    click_at(page, 0.7)
    assert "&b=" in address(page) and float(address(page).split("&a=")[1].split("&")[0]) == pytest.approx(0.7, abs=0.01)
    open_at(page, "#test=sweep%2F1&a=0.1&b=0.3")
    assert page.locator(".between >> nth=0 >> thead th").all_inner_texts()[1:3] == ["A 0.1 s", "B 0.3 s"]
    page.keyboard.press("Escape")
    assert page.locator(".between td").count() == 0 and "a=" not in address(page)
    # a drag zooms, and sets none
    box = page.locator(".u-over").first.bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 300, box["y"] + 40, steps=4)
    page.mouse.up()
    assert "from=" in address(page) and "a=" not in address(page)
    page.click("button[data-cursor=B]")
    click_at(page, 0.5)
    assert "&b=" in address(page) and "&a=" not in address(page)
    assert not page.faults


def test_errors_have_the_unit_of_their_channel(page: Any) -> None:
    shown = Exploration(1, ["far", "near", "angle"])
    models = {"far": {"a_m": TIME + 0.2, "b_deg": TIME}, "near": {"a_m": TIME + 1.234e-7}, "angle": {"b_deg": TIME + 2e-4}}
    shown.add("a", "a", TIME, {"a_m": TIME, "b_deg": TIME}, models, {"angle": {"b_deg": 2e-4, "a_m": float("nan")}})
    file = Path(page.file.removeprefix("file://")).with_name("small.html")
    file.write_text(discrepancy_page("Small", "", [explorer_html(shown)]), encoding="utf-8")
    page.goto(file.as_uri())
    page.wait_for_selector("#explorer[data-ready]", timeout=20_000)
    assert page.locator("tbody td").all_inner_texts() == ["a", "200 mm", "1.23e-4 mm", ""]
    page.select_option("select", "b_deg")
    assert page.locator("tbody td").all_inner_texts() == ["a", "0 deg", "", "2.00e-4 deg"]


def test_narrow_dark_and_nothing_fetched(page: Any) -> None:
    page.emulate_media(color_scheme="dark")
    page.set_viewport_size({"width": 500, "height": 900})
    open_at(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= 500
    assert {url for url in page.asked if not url.startswith(("file:", "about:"))} == set()
    page.emulate_media(media="print")
    assert not page.is_visible("#explorer")
    page.emulate_media(media="screen", color_scheme="light")
    page.set_viewport_size({"width": 1400, "height": 1000})
    assert not page.faults


def test_the_list_of_tests_is_not_cut_and_residuals_say_of_what(page: Any) -> None:
    def opened(name: str, models: list[str], observed: str = "measured") -> None:
        shown = Exploration(1, models, observed=observed)
        shown.add(name, "a", TIME, {"a_m": TIME}, {one: {"a_m": TIME + 0.1} for one in models})
        file = Path(page.file.removeprefix("file://")).with_name("other.html")
        file.write_text(discrepancy_page("Cart", "", [explorer_html(shown)]), encoding="utf-8")
        page.goto("about:blank")
        page.goto(file.as_uri())
        page.wait_for_selector("#explorer[data-ready]", timeout=20_000)

    opened("cycloid_neg__pid/1", ["published", "published, calibrated"])
    assert page.evaluate("(one => one.scrollWidth - one.clientWidth)(document.querySelector('#explorer .list'))") == 0
    assert page.locator("#explorer .title b").nth(1).inner_text() == "a: model − measured (mm)"
    opened("a", ["reference"])
    assert page.locator("#explorer .title b").nth(1).inner_text() == "a: reference − measured (mm)"
    opened("a", ["reference"], "simulated")
    assert page.locator("#explorer .title b").nth(1).inner_text() == "a: reference − simulated (mm)"
    assert page.locator("button[data-of=simulated]").count() == 1 and "what was simulated" in page.inner_text(".keys")


def test_paper_cuts_no_table_and_no_picture(page: Any) -> None:
    headings = [f"indicator {k}" for k in range(10)]
    wide = picture("Wide", '<svg viewBox="0 0 900 90" width="900pt"><text x="1" y="9">a</text></svg>')
    file = Path(page.file.removeprefix("file://")).with_name("paper.html")
    file.write_text(discrepancy_page("Wide", "", [table_of(headings, [["19.77 ± 4.72"] * 10]), wide]), encoding="utf-8")
    page.set_viewport_size({"width": 718, "height": 1000})  # A4 within the usual margins
    page.goto(file.as_uri())
    assert page.evaluate("document.querySelector('figure').scrollWidth") > 718
    page.emulate_media(media="print")
    for one in ("figure", ".scroll"):
        assert page.evaluate(f"document.querySelector('{one}').scrollWidth") <= 718
    page.emulate_media(media="screen")
    page.set_viewport_size({"width": 1400, "height": 1000})
