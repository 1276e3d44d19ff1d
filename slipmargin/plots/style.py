"""The one style of every figure: colours that the colour-blind can tell apart, quiet axes, no globals."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from io import BytesIO, StringIO
from pathlib import Path
from typing import ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Figure  # what plot() returns: other rooms take its type from here

from slipmargin.io.writes import check_format, write_bytes
from slipmargin.report.page import Image

#: Okabe and Ito's palette (J*FLY, 2008).
BLUE, ORANGE, GREEN, RED, PURPLE = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7"
SKY, INK, GREY, PALE = "#56B4E9", "#222222", "#767676", "#D9D9D9"

#: Matplotlib settings, applied only inside :func:`styled` functions.
STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "grid.color": PALE,
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.8,
    "figure.dpi": 150,
    "savefig.dpi": 150,
    "svg.hashsalt": "slipmargin",
    "svg.fonttype": "none",
    "text.parse_math": False,  # a $ in a name is a dollar
}
#: One colour a wheel, the same in every figure; more than six wheels repeat them with another dash.
WHEELS = (BLUE, ORANGE, GREEN, PURPLE, SKY, RED)
#: Size of a figure that stands beside others on a page, whole in a window of 400 px [inches].
PANEL = (5.4, 4.6)
_NO_DATE: dict[str, dict[str, None]] = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """A drawing function that runs in the house style and leaves matplotlib's settings alone."""

    @wraps(draw)
    def in_style(*args: P.args, **kwargs: P.kwargs) -> R:
        with mpl.rc_context(STYLE):  # type: ignore[arg-type]
            return draw(*args, **kwargs)

    return in_style


@contextmanager
def _any_letter() -> Iterator[None]:
    """Without a warning for letters of a name that the font lacks: a box stands for them."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


@styled
def picture(figure: Figure, ending: str) -> bytes:
    """The figure as a file would hold it, png, svg or pdf; the same figure gives the same bytes."""
    out = BytesIO()
    with _any_letter():
        figure.savefig(out, format=ending, metadata=_NO_DATE[ending])
    return out.getvalue()


@styled
def image(figure: Figure, *, png: bool = False) -> Image:
    """The figure as a page holds it: SVG text, and PNG bytes where it gets a file of its own."""
    out, raster = StringIO(), BytesIO()
    with _any_letter():
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
        if png:
            figure.savefig(raster, format="png", metadata={"Software": None})
    return Image(svg=out.getvalue(), width_in=figure.get_figwidth(), png=raster.getvalue() if png else None)


def below(axes: Axes, ncols: int) -> None:
    """The legend under the axes, where it covers no curve."""
    more = 0.06 * axes.get_xlabel().count("\n")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16 - more), ncols=ncols)


def outside(figure: Figure, marks: Sequence[Artist], most: int | None = None) -> None:
    """A legend under all axes, in as many columns, at ``most``, as the figure is wide enough for."""
    renderer = FigureCanvasAgg(figure).get_renderer()  # type: ignore[no-untyped-call]
    for ncols in range(most or len(marks), 0, -1):
        legend = figure.legend(handles=marks, loc="outside lower center", ncols=ncols)
        if legend.get_window_extent(renderer).width <= figure.bbox.width:
            return
        legend.remove()
    figure.legend(handles=marks, loc="outside lower center")


def images(figures: Mapping[str, Figure]) -> dict[str, Image]:
    """Several figures as a page holds them, by name."""
    return {name: image(figure) for name, figure in figures.items()}


def save(figure: Figure, path: Path | str) -> None:
    """Write a figure whole or not at all; the format is the name's ending.

    Raises
    ------
    InputError
        Where the ending is unknown or the file cannot be written.
    """
    write_bytes(path, picture(figure, check_format(path)))
