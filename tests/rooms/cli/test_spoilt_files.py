"""Files as editors, copies and file systems spoil them: read as they are meant, or one line and status 2."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from slipmargin_cli.main import status

RIG = Path(__file__).resolve().parents[2] / "data" / "rig" / "a-null"
ROBOT = (RIG / "robot.toml").read_bytes()
HEAD = (RIG / "dataset.toml").read_bytes()
WAYS = b"x_m,y_m,phi_rad\n0,0,0\n1,0,0\n1,1,0\n"
MOTION = b"t_s,x_m,y_m,phi_rad\n" + b"".join(b"%.1f,%.4f,0,0\n" % (0.1 * k, 1e-3 * k**2) for k in range(8))
SPEEDS = b"t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,1,1\n0.1,1,1,1\n0.2,1,1,1\n"
PULLS = b"phi_rad,force_N\n" + b"".join(b"%.4f,%.3f\n" % (0.1 * k, 5.0 + 0.1 * (k % 3)) for k in range(13))
LOG = b"t,x,y,h,w1,w2,w3\n" + b"".join(b"%d,%d,%d,%d,1,1,1\n" % (10 * k, k, -k, k) for k in range(30))
MAP = b"""schema = 1
[time]
column = "t"
unit = "ms"
[pose]
x = { column = "x", unit = "mm" }
y = { column = "y", unit = "mm" }
heading = { column = "h", unit = "deg" }
""" + b"".join(b'[[wheel]]\nspeed = { column = "w%d", unit = "rpm" }\n' % i for i in (1, 2, 3))
CAMPAIGN = b'schema = 1\n[[data_set]]\npath = "d"\n[[data_set]]\npath = "e"\n'
KIWI = ("--surface", "paper")
#: File that is spoilt → what it holds, and the command that reads it.
READERS: dict[str, tuple[bytes, tuple[str, ...]]] = {
    "r.toml": (ROBOT, ("sweep", "r.toml", "--surface", "floor", "--step", "90")),
    "w.csv": (WAYS, ("plan", "ohio-kiwi", "w.csv", *KIWI, "--points", "40", "--step", "0.05")),
    "t.csv": (MOTION, ("check", "ohio-kiwi", "t.csv", *KIWI)),
    "c.csv": (SPEEDS, ("simulate", "ohio-kiwi", "c.csv", *KIWI, "--step", "0.05")),
    "s.csv": (SPEEDS, ("monitor", "ohio-kiwi", "s.csv", *KIWI, "--false-alarms", "0.5")),
    "p.csv": (PULLS, ("sweep", "ohio-kiwi", *KIWI, "--step", "90", "--measured", "p.csv")),
    "l.csv": (LOG, ("import", "csv", "l.csv", "--map", "m.toml", "--robot", "ohio-kiwi", "--out", "o")),
    "m.toml": (MAP, ("import", "csv", "l.csv", "--map", "m.toml", "--robot", "ohio-kiwi", "--out", "o")),
    "d/dataset.toml": (HEAD, ("diagnose", "d", "--out", "o")),
    "d/pulls.csv": (PULLS, ("diagnose", "d", "--out", "o")),
    "campaign.toml": (CAMPAIGN, ("diagnose", "campaign.toml", "--out", "o")),
}
#: Of these even a good file is not carried out here: a diagnosis takes seconds.
LONG = ("d/dataset.toml", "d/pulls.csv", "campaign.toml")


def _looped(path: Path, data: bytes) -> None:
    path.symlink_to(path)


def _folder(path: Path, data: bytes) -> None:
    path.mkdir()


def _pipe(path: Path, data: bytes) -> None:
    os.mkfifo(path)
    threading.Thread(target=path.write_bytes, args=(b"",), daemon=True).start()


def _bytes(change: Callable[[bytes], bytes]) -> Callable[[Path, bytes], None]:
    def spoil(path: Path, data: bytes) -> None:
        path.write_bytes(change(data))

    return spoil


AS_MEANT = {
    "with a mark of the byte order": _bytes(lambda data: b"\xef\xbb\xbf" + data),
    "with lines as on Windows": _bytes(lambda data: data.replace(b"\n", b"\r\n")),
    "without a last line end": _bytes(lambda data: data.rstrip(b"\n")),
}
REFUSED = {
    "empty": _bytes(lambda data: b""),
    "blank": _bytes(lambda data: b" \n\n"),
    "of two bytes a letter": _bytes(lambda data: data.decode().encode("utf-16")),
    "with zeros inside": _bytes(lambda data: data[: len(data) // 2] + b"\0" * 9 + data[len(data) // 2 :]),
    "of zeros": _bytes(lambda data: b"\0" * 4096),
    "of random bytes": _bytes(lambda data: bytes((7 * k * k + 13 * k) % 256 for k in range(4096))),
    "a link to itself": _looped,
    "a folder": _folder,
    "an empty pipe": _pipe,
}  # fmt: skip


def told(
    name: str, spoil: Callable[[Path, bytes], None], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> int:
    """The exit status of the command that reads the spoilt file; what was there before is there after."""
    monkeypatch.chdir(folder)
    for place in ("d", "e"):
        (folder / place).mkdir()
        (folder / place / "robot.toml").write_bytes(ROBOT)
    others = {"l.csv": LOG, "m.toml": MAP, "d/dataset.toml": HEAD, "e/dataset.toml": HEAD}
    for other, data in others.items():
        if other != name:
            (folder / other).write_bytes(data)
    spoil(folder / name, READERS[name][0])
    before = sorted(folder.rglob("*"))
    code = status([*READERS[name][1], *([] if name in (*LONG, "l.csv", "m.toml") else ["--json", "o.json"])])
    if code:
        assert sorted(folder.rglob("*")) == before
    return code


#: A row of a log that cannot be read is dropped, and named; the others are taken.
DROPPED = ("l.csv", "with zeros inside")


@pytest.mark.parametrize(("name", "how"), [(n, h) for n in READERS for h in REFUSED if (n, h) != DROPPED])
def test_a_file_that_cannot_be_read_is_refused_in_one_line(
    name: str, how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told(name, REFUSED[how], tmp_path, monkeypatch) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("error: ") and err.count("\n") == 1, err
    assert Path(name).stem in err or name in LONG, err


@pytest.mark.parametrize("how", AS_MEANT)
@pytest.mark.parametrize("name", [name for name in READERS if name not in LONG])
def test_a_file_of_another_editor_is_read_as_it_is_meant(
    name: str, how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told(name, AS_MEANT[how], tmp_path, monkeypatch) == 0, capsys.readouterr().err
