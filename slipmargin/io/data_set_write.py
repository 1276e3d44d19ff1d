"""A data set onto the disk: the whole folder or nothing."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from slipmargin.data.data_set import DataSet
from slipmargin.errors import InputError
from slipmargin.io.data_set import FILE
from slipmargin.io.robot_text import quoted, write_recipe
from slipmargin.io.stage import NEW, OLD, check_possible, staged, sweep
from slipmargin.io.trial_file import pulls_text, trial_parts


def _small_files(data_set: DataSet, comment: str) -> dict[str, str]:
    """Everything but the runs."""
    head = [f"# {line}".rstrip() for line in comment.splitlines()]
    head += [
        "schema = 1",
        'robot = "robot.toml"',
        f"surface = {quoted(data_set.surface)}",
    ]
    if data_set.trials:
        head.append(f'wheel_signal = "{data_set.wheel_signal.value}"')
    if data_set.nominal_rate_Hz is not None:
        head.append(f"nominal_rate_Hz = {data_set.nominal_rate_Hz!r}")
    pulls = data_set.pulls
    if data_set.sigma is not None or (pulls is not None and pulls.sigma_N is not None):
        head += ["", "[sigma]"]
    if data_set.sigma is not None:
        names = ("x_m", "y_m", "phi_rad")
        head += [f"{n} = {v!r}" for n, v in zip(names, data_set.sigma.tolist(), strict=True)]
    if pulls is not None and pulls.sigma_N is not None:
        head.append(f"force_N = {pulls.sigma_N!r}")
    files = {"robot.toml": write_recipe(data_set.recipe), FILE: "\n".join(head) + "\n"}
    if pulls is not None:
        files["pulls.csv"] = pulls_text(pulls)
    return files


#: What importing a log writes, and may replace.
_IMPORTED = (FILE, "robot.toml", "import.json", "calibration.toml", "trials")


def check_data_set_place(folder: Path, written: Iterable[str] = _IMPORTED) -> None:
    """Refuse a place that holds something else than a data set, before any work is done.

    So is one that holds what is not ``written`` again: it would be lost.

    Raises
    ------
    InputError
        Where the folder exists and is neither empty nor such a data set, or its parent does not exist.
    """
    check_possible(folder)
    sweep(folder.resolve())  # what a killed run took away comes back
    if folder.is_dir():
        if any(folder.iterdir()) and not (folder / FILE).is_file():
            raise InputError("--out", "is a folder that holds something else", "give a new one", str(folder))
        known = {*_IMPORTED, *written}
        lost = sorted(path.name for path in folder.iterdir() if path.name not in known)
        if lost:
            problem = f"holds {', '.join(lost[:5])} beside a data set, which would be lost"
            raise InputError("--out", problem, "move that away, or give a new folder", str(folder))
    elif folder.exists():
        raise InputError("--out", "is a file", "give a new folder", str(folder))
    elif not folder.resolve().parent.is_dir():
        raise InputError("--out", "its parent folder does not exist", "create it first", str(folder))


def check_new(folder: Path) -> None:
    """Refuse a place where a data set stands already.

    Raises
    ------
    InputError
        Placed at ``--out``, with the cure.
    """
    check_data_set_place(folder)
    if (folder / FILE).is_file():
        raise InputError(
            "--out", "holds a data set already", "give a new folder, or replace it with --force", str(folder)
        )


def write_data_set(
    folder: Path, data_set: DataSet, extra: Mapping[str, str] | None = None, comment: str = ""
) -> None:
    """Write a data set; a data set that stands there already is replaced when all is written.

    Parameters
    ----------
    extra : mapping
        Further files, path inside the folder → text (a calibration, a summary).

    Raises
    ------
    InputError
        Where the folder cannot be written or holds something else.
    """
    small = {**_small_files(data_set, comment), **(extra or {})}
    check_data_set_place(folder, (Path(name).parts[0] for name in small))
    folder = folder.resolve()
    try:
        with staged(folder) as stage:
            files: dict[str, Iterable[str]] = {name: (text,) for name, text in small.items()}
            files |= {f"trials/{trial.name}.csv": trial_parts(trial) for trial in data_set.trials}
            for name, parts in files.items():
                path = stage / NEW / name
                path.parent.mkdir(parents=True, exist_ok=True)
                with path.open("w", encoding="utf-8", newline="") as file:
                    file.writelines(parts)
            _exchange(folder, stage)
    except OSError as fault:
        raise InputError(
            "--out", f"cannot be written ({fault.strerror})", "choose another place", str(folder)
        ) from None


def _exchange(folder: Path, stage: Path) -> None:
    """Put what is new in the place of what is old, or leave what is old there."""
    if folder.exists():
        os.replace(folder, stage / OLD)
    try:
        os.replace(stage / NEW, folder)
    except BaseException:
        if (stage / OLD).exists():
            os.replace(stage / OLD, folder)
        raise
