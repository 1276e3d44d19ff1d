"""The server of the local page answers its own address only, and says what is wrong."""

from __future__ import annotations

import http.client
import json
import math
import shlex
import statistics
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from robot_files import GOOD

import slipmargin as sm
from slipmargin.api.robots import read_robot
from slipmargin.errors import InputError
from slipmargin.live.picture import pulls
from slipmargin.live.server import HOST, LARGEST, Server
from slipmargin.live.settings import settings
from slipmargin.study.robot_on_surface import RobotOnSurface


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    one = sm.explore("ohio-kiwi", "paper").serve()
    threading.Thread(target=one.serve_forever, daemon=True).start()
    yield one
    one.shutdown()
    one.server_close()


def ask(
    server: Server, path: str, method: str = "GET", **headers: str
) -> tuple[int, http.client.HTTPMessage, bytes]:
    line = http.client.HTTPConnection(HOST, server.server_port, timeout=60)
    line.request(method, path, headers={k.replace("_", "-"): v for k, v in headers.items()})
    answer = line.getresponse()
    body = answer.read()
    line.close()
    return answer.status, answer.headers, body


def test_it_listens_at_this_machine_only(server: Server) -> None:
    assert server.server_address[0] == "127.0.0.1"


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "127.0.0.1"},
        {"Host": "127.0.0.1:1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "https://127.0.0.1"},
    ],
)
@pytest.mark.parametrize("path", ["/", "/api/limits", "/api/report"])
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_other_hosts_and_origins_are_refused(
    server: Server, headers: dict[str, str], path: str, method: str
) -> None:
    status, _, body = ask(server, path, method, **headers)
    assert (status, json.loads(body)) == (403, {"error": "this page answers its own address only"})


def test_its_own_origin_is_answered(server: Server) -> None:
    for name in ("127.0.0.1", "localhost"):
        at = f"{name}:{server.server_port}"
        assert ask(server, "/api/robot", Host=at, Origin=f"http://{at}")[0] == 200


def test_the_page_may_load_nothing_else(server: Server) -> None:
    for path in ("/", "/page.js", "/page.css"):
        status, headers, body = ask(server, path)
        assert status == 200 and headers["Content-Security-Policy"].startswith("default-src 'none'")
        assert b"http://" not in body.replace(b"http://www.w3.org/2000/svg", b"") and b"https://" not in body


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("/api/limits?mu=much", "mu: is 'much', not a number, give a number"),
        ("/api/limits?mu=99", "mu: is 99"),
        ("/api/limits?colour=3", "colour: is no slider of this robot, use one of: mu,"),
        ("/api/export?tool=word", "export: is 'word', use one of: nav2"),
    ],
)
def test_a_wrong_question_gets_one_sentence(server: Server, path: str, said: str) -> None:
    status, _, body = ask(server, path)
    assert status == 400 and json.loads(body)["error"].startswith(said)


def test_what_is_not_there_is_not_found(server: Server) -> None:
    assert ask(server, "/../pyproject.toml")[0] == 404
    assert ask(server, "/api/nothing")[0] == 404


def test_a_file_that_is_too_large_is_refused(server: Server) -> None:
    assert ask(server, "/api/pulls", "POST", Content_Length=str(LARGEST + 1))[0] == 413


def test_a_port_that_is_taken_is_refused(server: Server) -> None:
    with pytest.raises(InputError, match=r"port: \d+: .*leave it out for a free one"):
        sm.explore("ohio-kiwi", "paper").serve(server.server_port)


@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4", "omni4", "robotino"])
def test_a_slider_at_the_files_value_changes_nothing(name: str) -> None:
    page = sm.explore(name)
    own = {s.key: s.value for s in page.sliders}
    assert page.picture(**own) == page.picture()
    assert sm.bounds(name, page.design.surface).recommended_m_s2 == pytest.approx(
        page.picture()["recommended"], rel=1e-5
    )


@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4", "omni4"])
def test_each_end_of_each_slider_is_answered_or_refused_in_a_sentence(name: str) -> None:
    page = sm.explore(name)
    for slider in page.sliders:
        for value in (slider.low, slider.high):
            try:
                found = page.picture(**{slider.key: value})
            except InputError as fault:
                assert str(fault)
            else:
                assert all(v is None or np.isfinite(v) for v in found["starting"])


def test_friction_keeps_the_ratios_of_the_floor() -> None:
    from slipmargin.live.settings import settings

    page = sm.explore("mecanum4", "carpet")
    old = page.design.robot.surface("carpet")
    new = settings(page.design, {"mu": 0.9}).design.robot.surface("carpet")
    assert new.roller.drive == 0.9
    assert new.rigid.transverse / new.roller.drive == pytest.approx(old.rigid.transverse / old.roller.drive)
    assert page.design.robot.surface("floor") == settings(page.design, {"mu": 0.9}).design.robot.surface(
        "floor"
    )


@pytest.mark.parametrize("grip", ["box", "disc-strip", "ellipse"])
def test_pure_forces_are_those_of_polytope(grip: str) -> None:
    """One source: the page draws the section of the robot's own grip, curved or not."""
    from slipmargin.sets.section import section

    robot = sm.read_robot("mecanum4", grip=grip)
    drawn = sm.explore(robot, "floor").picture()["section"]
    ring = section(sm.polytope(robot, "floor").body)
    right, forward = robot.robot.convention.right_forward(ring[:, 0], ring[:, 1])
    assert np.allclose(drawn["right"], right, rtol=1e-5) and np.allclose(drawn["forward"], forward, rtol=1e-5)


def test_another_tools_file_for_the_same_numbers_is_not_computed_again() -> None:
    page = sm.explore("ohio-kiwi", "paper")
    first = page.export("nav2", mu=0.3)
    (kept,) = page.kept.values()
    page.export("choreo", mu=0.3)
    assert [found is kept for found in page.kept.values()] == [True]
    page.export("nav2", mu=0.31)
    assert page.export("nav2", mu=0.3) == first


def test_a_name_is_one_word_of_the_command_to_copy(tmp_path: Path) -> None:
    """A robot file from elsewhere could name itself so that pasting the command ran what it liked."""
    name = "kiwi; touch x `id` $(id)"
    file = tmp_path / "r.toml"
    file.write_text(
        GOOD.replace('name = "kiwi"', f'name = "{name}"').replace("[surface.paper", '[surface."a $(id)"'),
        encoding="utf-8",
    )
    page = sm.explore(file, "a $(id)")
    words = shlex.split(page.export("nav2", margin=0.2)["command"])
    assert words[:5] == ["slipmargin", "bounds", str(file), "--surface", "a $(id)"]
    words = shlex.split(page.export("nav2", com_height_m=0.01)["command"])
    assert words[:5] == ["slipmargin", "bounds", f"{name}.toml", "--surface", "a $(id)"]


@pytest.mark.parametrize("tool", ["nav2", "roadrunner", "pathplanner", "choreo", "json"])
@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4"])
def test_an_export_is_what_bounds_says_to_the_last_digit(name: str, tool: str) -> None:
    """The page finds the safe sets alone, ``bounds`` everything: the files are the same."""
    page = sm.explore(name)
    ending = {"nav2": ".yaml", "roadrunner": ".txt"}.get(tool, ".json")  # fields of a class are no Java file
    assert page.export(tool)["command"].endswith(ending)
    floor = page.design.surface
    assert page.export(tool)["text"] == sm.bounds(name, floor).export_text(tool)
    moved = page.export(tool, margin=0.2, yaw_share=0.2)
    yaw = float(moved["command"].split("--yaw ")[1].split()[0])
    assert moved["text"] == sm.bounds(name, floor, margin=0.2, yaw_rad_s2=yaw).export_text(tool)


@pytest.mark.parametrize(("name", "most_ms"), [("ohio-kiwi", 50.0), ("mecanum4", 140.0)])
def test_an_export_follows_a_slider(name: str, most_ms: float) -> None:
    """Processor time of one position: 12 ms with three wheels and 31 with four, 105 and 283 at first."""
    page, spent = sm.explore(name), []
    own = {s.key: s.value for s in page.sliders}["mu"]
    page.export("nav2")
    for k in range(7):
        start = time.process_time()
        page.export("nav2", mu=own * (1.0 - 0.01 * k))
        spent.append(1e3 * (time.process_time() - start))
    assert statistics.median(spent[1:]) < most_ms


def test_answers_are_json_whatever_they_hold_and_a_defect_is_told(server: Server) -> None:
    """A number that is not finite was written as NaN, which no browser reads; a defect ended the answer."""

    def breaks(query: object, file: object) -> object:
        raise ZeroDivisionError("float division by zero")

    server.answers = {**server.answers, "odd": lambda query, file: {"x": [math.nan, np.inf]}, "bad": breaks}
    assert json.loads(ask(server, "/api/odd")[2])["x"] == [None, None]
    status, _, body = ask(server, "/api/bad")
    assert status == 500 and "ZeroDivisionError" in json.loads(body)["error"]


def test_the_page_on_explore_quotes_what_was_measured() -> None:
    root = Path(__file__).resolve().parents[3]
    page = " ".join((root / "docs/how-to/explore.md").read_text(encoding="utf-8").split())
    measured = json.loads((root / "benchmarks/results/explore.json").read_text(encoding="utf-8"))

    def rows(kind: str, *wheels: int) -> list[dict[str, float]]:
        return [
            times
            for row in measured.values()
            for name, times in row.items()
            if row["wheels"] in wheels and name.startswith(f"{kind}, ")
        ]

    def medians(kind: str, *wheels: int) -> str:
        found = [times["median_ms"] for times in rows(kind, *wheels)]
        return f"{min(found):.0f} to {max(found):.0f} ms"

    assert f"A picture takes {medians('picture', 3, 4)} of computing" in page
    assert f"and {max(times['most_ms'] for times in rows('picture', 3, 4)):.0f} ms at most" in page
    assert f"{medians('file', 3)} with three wheels and {medians('file', 4)} with four" in page
    assert f"take up to {max(times['most_ms'] for times in rows('file', 4)):.0f} ms" in page
    assert f"takes {medians('JSON', 4)} with four wheels" in page
    assert max(times["median_ms"] for times in rows("file", 3, 4)) < 50.0


def test_a_robot_without_height_never_tips() -> None:
    """At a height of 1e-12 m its wheels lifted at 3e11 m/s²."""
    page = sm.explore("mecanum4", "floor")
    assert page.picture(com_height_m=1e-12)["tipping"] is None
    assert page.picture(com_height_m=0.1)["tipping"]["m_s2"] < 50.0


def test_pulls_of_their_own_direction_are_refused_beside_one_sweep(tmp_path: Path) -> None:
    now = settings(RobotOnSurface(recipe=read_robot("ohio-kiwi"), surface="paper"), {})
    file = tmp_path / "pulls.csv"
    file.write_text("phi_rad,force_N\n0.001,5\n6.2822,7\n", encoding="utf-8")
    (point,) = pulls(now, file)["points"]
    assert point["mean"] == 6.0
    file.write_text("phi_rad,force_N,direction_rad\n0.001,5,1.57\n", encoding="utf-8")
    with pytest.raises(InputError, match="direction, a point or a height"):
        pulls(now, file)
