"""The local page in a real browser: sliders move curves, exports are the command's, no other host."""

from __future__ import annotations

import statistics
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from browser import browser, needs_browser
from slipmargin_cli.main import status

import slipmargin as sm

pytestmark = needs_browser
REPORT = "<!DOCTYPE html><html><body><h1>A report</h1><script>document.title='ran'</script></body></html>"


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """The page of mecanum4 in a window, with what its console said and what it asked."""
    folder = tmp_path_factory.mktemp("report")
    report = folder / "report.html"
    report.write_text(REPORT, encoding="utf-8")
    explorer = sm.explore("mecanum4", "floor", report=report)
    server = explorer.serve()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with browser() as chromium:
            page = chromium.new_page(viewport={"width": 1280, "height": 900})
            page.set_default_timeout(20_000)
            page.said, page.asked = [], []
            page.on("console", lambda message: page.said.append((message.type, message.text)))
            page.on("pageerror", lambda fault: page.said.append(("error", str(fault))))
            page.on("request", lambda request: page.asked.append(request.url))
            page.goto(server.address)
            page.wait_for_selector("#curve-starting")
            yield page
    finally:
        server.shutdown()
        server.server_close()


def move(page: Any, key: str, value: float) -> None:
    """Move a slider as a hand does, and wait until everything is drawn."""
    before = int(page.evaluate("document.body.dataset.drawn"))
    page.evaluate(
        "([key, value]) => { const s = document.getElementById('s-' + key); s.value = value;"
        " s.dispatchEvent(new Event('input', {bubbles: true})); }",
        [key, value],
    )
    page.wait_for_function("n => Number(document.body.dataset.drawn) > n", arg=before)


@pytest.fixture
def page(opened: Any) -> Any:
    opened.click("#tab-limits")
    before = int(opened.evaluate("document.body.dataset.drawn"))
    opened.click("#reset")
    opened.wait_for_function("n => Number(document.body.dataset.drawn) > n", arg=before)
    return opened


@pytest.mark.parametrize(
    ("key", "value", "moved"),
    [
        ("mu", 0.2, "#facts"),
        ("com_height_m", 0.3, "#facts"),
        ("com_x_m", 0.05, "#robot"),
        ("com_y_m", 0.06, "#curve-starting"),
        ("roller_angle_deg", 35.0, "#curve-section"),
        ("margin", 0.4, "#polar"),
    ],
)
def test_a_slider_moves_what_depends_on_it(page: Any, key: str, value: float, moved: str) -> None:
    before = page.eval_on_selector(moved, "e => e.outerHTML")
    move(page, key, value)
    assert page.eval_on_selector(moved, "e => e.outerHTML") != before


def test_what_a_curve_shows_is_what_the_function_says(page: Any) -> None:
    move(page, "mu", 0.25)
    answer = sm.explore("mecanum4", "floor").picture(mu=0.25)
    said = page.inner_text("#facts div:first-child dd")
    assert said == f"{answer['recommended']:.3g} m/s² with the margin".split(" with")[0]


@pytest.mark.parametrize("tool", ["nav2", "roadrunner", "pathplanner", "choreo", "json"])
def test_the_export_is_the_commands_to_the_last_digit(
    page: Any, tool: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page's robot file and its command line, carried out, write the page's file."""
    move(page, "mu", 0.33)
    move(page, "margin", 0.17)
    move(page, "yaw_share", 0.2)
    page.click("#tab-export")
    page.select_option("#tool", tool)
    page.wait_for_function(
        "tool => document.getElementById('command').textContent.includes(`--export ${tool} `)", arg=tool
    )
    page.wait_for_function("() => document.getElementById('stale').textContent === ''")
    monkeypatch.chdir(tmp_path)
    command = page.text_content("#command").split()
    Path(command[2]).write_text(page.text_content("#file"), encoding="utf-8")
    assert command[0] == "slipmargin" and status(command[1:]) == 0
    assert Path(command[-1]).read_text(encoding="utf-8") == page.text_content("#text")


def test_with_the_files_own_numbers_the_command_names_the_robot(page: Any, tmp_path: Path) -> None:
    page.click("#tab-export")
    page.select_option("#tool", "nav2")
    page.wait_for_function(
        "() => document.getElementById('command').textContent.endsWith('floor --export nav2 limits.yaml')"
    )
    assert page.text_content("#command") == (
        "slipmargin bounds mecanum4 --surface floor --export nav2 limits.yaml"
    )
    file = tmp_path / "limits.yaml"
    assert status(["bounds", "mecanum4", "--surface", "floor", "--export", "nav2", str(file)]) == 0
    assert file.read_text(encoding="utf-8") == page.text_content("#text")


def test_measured_pulls_are_shown_and_a_wrong_file_is_named(page: Any, tmp_path: Path) -> None:
    good, bad = tmp_path / "pulls.csv", tmp_path / "bad.csv"
    good.write_text("phi_rad,force_N\n0.0,14.0\n0.0,15.0\n1.5708,16.0\n", encoding="utf-8")
    bad.write_text("phi_rad,force_N\n0.0,heavy\n", encoding="utf-8")
    page.click("#tab-pulls")
    page.set_input_files("#csv", str(good))
    page.wait_for_selector(".point")
    assert page.locator(".point").count() == 2
    assert "pulls.csv: 2 orientations" in page.text_content("#pull-words")
    words = page.text_content("#pull-words")
    page.evaluate("() => { document.getElementById('s-mu').value = 0.3; }")
    page.dispatch_event("#s-mu", "input")
    page.wait_for_function("w => document.getElementById('pull-words').textContent !== w", arg=words)
    page.click("#forget")
    page.wait_for_function("() => document.querySelectorAll('.point').length === 0")
    page.set_input_files("#csv", str(bad))
    page.wait_for_function("() => document.getElementById('pull-words').textContent.includes('bad.csv: 2:2')")
    page.said[:] = [said for said in page.said if "status of 400" not in said[1]]  # the browser's own line


def test_a_report_is_shown_and_runs_nothing(page: Any) -> None:
    page.click("#tab-report")
    frame = page.frame_locator("#shown")
    assert frame.locator("h1").inner_text() == "A report"
    assert page.title() != "ran"
    page.said[:] = [said for said in page.said if "sandboxed" not in said[1]]  # the script it was kept from


def test_copy_buttons_copy(page: Any) -> None:
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.click("#tab-export")
    page.wait_for_function("() => document.getElementById('stale').textContent === ''")
    page.click("[data-copy=text]")
    page.wait_for_function("() => document.querySelector('[data-copy=text]').textContent === 'Copied'")
    assert page.evaluate("navigator.clipboard.readText()") == page.text_content("#text")


def test_it_follows_within_50_ms(page: Any) -> None:
    """Processor time of the server for one position of a slider."""
    spent = []
    for k in range(12):
        with page.expect_response("**/api/limits*") as answer:
            move(page, "mu", 0.2 + 0.01 * k)
        spent.append(float(answer.value.headers["server-timing"].partition("dur=")[2]))
    assert statistics.median(spent) < 50.0


@pytest.mark.parametrize("width", [400, 1280])
def test_nothing_hangs_over_the_side(page: Any, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    for name in ("limits", "export", "pulls", "report"):
        page.click(f"#tab-{name}")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.set_viewport_size({"width": 1280, "height": 900})


def test_the_console_is_silent_and_no_other_host_is_asked(page: Any) -> None:
    """The last test of the file: it judges what all the others did."""
    assert not [said for said in page.said if said[0] in {"error", "warning"}]
    hosts = {urlsplit(url).netloc for url in page.asked if urlsplit(url).scheme in {"http", "https", "ws"}}
    assert hosts == {urlsplit(page.url).netloc}
