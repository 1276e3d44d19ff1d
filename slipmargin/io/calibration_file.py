"""A calibration as a TOML file, to be held fixed on other floors."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipmargin.checks import real
from slipmargin.data.calibration import Calibration
from slipmargin.errors import InputError
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import document

_HEAD = """\
# Camera against wheels, estimated on the floor with the least slip; hold it fixed on the others.
# measured = scale · R(rotation) · wheels, read delay late; sd: one standard deviation.
"""


def calibration_text(calibration: Calibration) -> str:
    """The file's text."""
    c = calibration
    lines = ["schema = 1"]
    for key in ("scale", "scale_sd", "rotation_rad", "rotation_sd_rad", "delay_s", "delay_sd_s", "spread"):
        lines.append(f"{key} = {float(getattr(c, key))!r}")
    for key in ("tilt_per_m", "tilt_sd_per_m", "middle_m"):
        lines.append(f"{key} = {getattr(c, key).tolist()!r}")
    return _HEAD + "\n".join([*lines, f"runs = {c.runs}"]) + "\n"


def read_calibration(path: Path) -> Calibration:
    """Read a calibration strictly.

    Raises
    ------
    InputError
        With file and key.
    """
    try:
        table = document(read_text(path), "`slipmargin import … --calibrate` writes one")

        def deviation(key: str, unit: str) -> float:
            found = table.number(key, unit, 0.0)
            return real(table.at(key), found, low=0.0, cure=f"give 0 or a positive number [{unit}]")

        found = Calibration(
            scale=real(
                table.at("scale"), table.number("scale", "1"), above=0.0, cure="give a positive number"
            ),
            scale_sd=deviation("scale_sd", "1"),
            rotation_rad=table.number("rotation_rad", "rad"),
            rotation_sd_rad=deviation("rotation_sd_rad", "rad"),
            delay_s=table.number("delay_s", "s"),
            delay_sd_s=deviation("delay_sd_s", "s"),
            tilt_per_m=np.array(table.numbers("tilt_per_m", 2, "1/m", (0.0, 0.0))),
            tilt_sd_per_m=np.array(table.numbers("tilt_sd_per_m", 2, "1/m", (0.0, 0.0))),
            middle_m=np.array(table.numbers("middle_m", 2, "m", (0.0, 0.0))),
            spread=deviation("spread", "1"),
            runs=table.whole("runs", 0),
        )
        table.done()
        return found
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None
