"""Input from a pipe: it can be read only once, and bytes that are no text are refused in one line."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from slipmargin_cli.main import status

from slipmargin.io import source

pytestmark = pytest.mark.skipif(not os.path.exists("/dev/fd"), reason="there is no /dev/fd")

WAYS = "x_m,y_m,phi_rad\n0,0,0\n1,0,0\n1,1,0\n"
MOTION = "t_s,x_m,y_m,phi_rad\n" + "".join(f"{0.1 * k:.1f},{0.001 * k**2:.4f},0,0\n" for k in range(8))
SPEEDS = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n" + "".join(f"{0.1 * k:.1f},1,1,1\n" for k in range(4))
PULLS = "phi_rad,force_N\n0,5\n0.5,5.1\n1,4.9\n"
KIWI = ("--surface", "paper")
#: A monitor that trains on few runs.
MONITOR = ("monitor", "ohio-kiwi", "FILE", *KIWI, "--false-alarms", "0.5")
#: Command line, with FILE where the pipe stands → what is piped.
READERS = {
    ("plan", "ohio-kiwi", "FILE", *KIWI, "--points", "40"): WAYS,
    ("check", "ohio-kiwi", "FILE", *KIWI): MOTION,
    ("simulate", "ohio-kiwi", "FILE", *KIWI): SPEEDS,
    MONITOR: SPEEDS,
    ("sweep", "ohio-kiwi", *KIWI, "--step", "45", "--measured", "FILE"): PULLS,
}


def piped(words: tuple[str, ...], data: bytes) -> int:
    """The exit status of a command that reads ``data`` from a pipe."""
    read, write = os.pipe()
    try:
        os.write(write, data)
        os.close(write)
        return status([f"/dev/fd/{read}" if word == "FILE" else word for word in words])
    finally:
        os.close(read)


@pytest.mark.parametrize("words", READERS, ids=lambda words: words[0])
def test_a_pipe_is_read_as_a_file(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert piped(words, READERS[words].encode()) == 0, capsys.readouterr().err


@pytest.mark.parametrize("words", READERS, ids=lambda words: words[0])
def test_a_pipe_that_is_no_text_is_refused(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    good = READERS[words].encode()
    lines = good.count(b"\n")
    assert piped(words, good + b"caf\xc3\xa9 \xff\n") == 2
    told = capsys.readouterr().err
    assert f"{lines + 1}:7: byte 0xff is not UTF-8 text" in told and told.count("\n") == 1


def test_what_never_ends_is_not_read_to_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """``/dev/zero`` as a robot or a log filled the memory."""
    monkeypatch.setattr(source, "FILE_B", 1 << 20)
    monkeypatch.setattr(source, "LINE", 1 << 16)
    assert status(["robots", "check", "/dev/zero"]) == 2
    assert "holds more than 1 MiB" in capsys.readouterr().err
    for command in ("simulate", "monitor"):
        assert status([command, "ohio-kiwi", "/dev/zero", *KIWI]) == 2
        assert "/dev/zero: 1:1: this line has more than 65536 letters" in capsys.readouterr().err
    with open("/dev/zero", encoding="utf-8") as endless:
        monkeypatch.setattr(sys, "stdin", endless)
        assert status(["monitor", "ohio-kiwi", "-", *KIWI]) == 2
    assert "this line has more than" in capsys.readouterr().err


@pytest.mark.parametrize("locale", ["utf-8", "ascii", "latin-1"])
def test_a_stream_that_is_no_text_is_refused(
    locale: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    data = io.BytesIO(SPEEDS.encode() + b"\xe9,1,1,1\n")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(data, encoding=locale))
    assert status(["-" if word == "FILE" else word for word in MONITOR]) == 2
    told = capsys.readouterr()
    assert "6:1: byte 0xe9 is not UTF-8 text" in told.err and len(told.out.splitlines()) == 5


def test_no_stdin_is_refused(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert status(["monitor", "ohio-kiwi", "-", *KIWI]) == 2
    assert "there is no stdin" in capsys.readouterr().err


def test_a_stream_that_nobody_reads_any_more_ends(tmp_path: Path) -> None:
    """``slipmargin monitor … - | head`` went on as long as the log did."""
    head = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s\n"
    words = ["monitor", "omni4", "-", "--surface", "floor", "--false-alarms", "0.5"]
    fed = subprocess.Popen(
        [sys.executable, "-m", "slipmargin", *words],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)},
    )  # fmt: skip
    assert fed.stdin is not None and fed.stdout is not None and fed.stderr is not None
    with pytest.raises(BrokenPipeError), fed:  # the feeder is told that nobody listens
        fed.stdin.write(f"{head}0.00,1,1,1,1\n0.01,1,1,1,1\n".encode())
        fed.stdin.flush()
        assert fed.stdout.readline().startswith(b"t_s,")
        fed.stdout.close()
        for k in range(2, 10**6):
            fed.stdin.write(f"{0.01 * k:.2f},1,1,1,1\n".encode())
            fed.stdin.flush()
    assert fed.returncode == 0
