"""The report pages of stop and monitor."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.api.monitor_log import POINTS, MonitoredLog, SlipEstimate, Tally


def test_stop_draws_and_reports(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page, plot = tmp_path / "stop.html", tmp_path / "stop.svg"
    words = ["stop", "mecanum4", "--surface", "floor", "--speed", "0.5", "--speed", "1", "--step", "90"]
    assert status([*words, "--no-verify", "--report", str(page), "--plot", str(plot)]) == 0
    assert f"written: {page}" in capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    found = sm.stop("mecanum4", "floor", speeds_m_s=[0.5, 1.0], step_deg=90.0, verify=False)
    longest = float(np.max(found.distance_m[:, -1]))
    assert f"{longest:.4g}\u00a0m" in text and "not simulated" in text
    for at in ("0°, to the right", "90°, forwards", "180°, to the left", "270°, backwards"):
        assert at in text.replace("\u00a0", " ")
    assert "grip of all wheels" in text and "front-right+front-left+rear-left+rear-right" not in text
    assert text.count('<th scope="row">') >= 4 and "<svg" in text and "forwards" in text
    assert "from 0.5 m/s" in plot.read_text(encoding="utf-8")


def estimate(t_s: float, alarm: bool) -> SlipEstimate:
    return SlipEstimate(
        t_s=t_s,
        slip_probability=0.9 if alarm else 0.1,
        log_ratio=2.0 if alarm else -2.0,
        alarm=alarm,
        wheel="left" if alarm else "",
        twist=np.zeros(3),
        covariance=np.eye(3),
    )


def log(alarms: str, *, quiet: bool = False) -> MonitoredLog:
    """A log with an alarm at each x."""
    tally = Tally()
    for k, c in enumerate(alarms):
        tally.append(estimate(0.1 * k, c == "x"))
    t_s, probability = tally.curve()
    return MonitoredLog(
        robot="r",
        surface="s",
        source="log.csv",
        false_alarm_rate=0.05,
        quiet=quiet,
        samples=tally.samples,
        alarms=tally.alarms,
        events=tuple(tally.events),
        t_s=t_s,
        probability=probability,
        warnings=(),
    )


def test_a_tally_of_any_length_keeps_a_short_curve_with_every_peak() -> None:
    tally = Tally()
    for k in range(50_001):
        tally.append(estimate(0.001 * k, k in (7, 31_234)))
    t_s, p = tally.curve()
    assert len(t_s) == len(p) <= 2 * POINTS and tally.samples == 50_001 and np.all(np.diff(t_s) > 0.0)
    assert sorted(np.flatnonzero(p > 0.5)) == [0, int(np.searchsorted(t_s, 31.234 + 1e-9)) - 1]


def test_a_monitored_log_tells_its_events() -> None:
    found = log("..xx.x....")
    assert [(round(e.start_s, 9), round(e.end_s, 9)) for e in found.events] == [(0.2, 0.3), (0.5, 0.5)]
    page = found.page_text()
    assert "slips 2 times" in page and "30.00\u00a0%" in page and "left" in page and "alarm" in page
    assert json.loads(found.to_json())["events"][0]["wheel"] == "left"
    calm = log("....").page_text()
    assert 'class="lead good"' in calm and "no sign of slip." in calm
    likely = replace(log("...."), probability=np.array([0.2, 0.99, 0.1, 0.1])).page_text()
    assert 'class="lead good"' not in likely and "although the slip probability reaches 0.99" in likely
    silent = log("....", quiet=True).page_text()
    assert "too few" in silent and 'class="lead attention"' in silent
    assert "0 samples" in log("").page_text()


def test_the_command_writes_every_file(tmp_path: Path) -> None:
    file = tmp_path / "log.csv"
    file.write_text("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,0,0,0\n0.01,0,0,0\n", encoding="utf-8")
    page, told, plot = (tmp_path / name for name in ("slip.html", "slip.json", "slip.svg"))
    words = ["monitor", "ohio-kiwi", str(file), "--surface", "paper", "--false-alarms", "0.1"]
    files = ["--report", str(page), "--json", str(told), "--plot", str(plot)]
    assert status([*words, *files]) == 0
    assert "no sign of slip" in page.read_text(encoding="utf-8")
    assert json.loads(told.read_text(encoding="utf-8"))["samples"] == 2 and plot.is_file()
