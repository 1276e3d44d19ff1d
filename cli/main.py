"""The command line's front door: which commands exist, and how failures are told.

To add a command, write ``cli/<command>.py`` with a function that takes typer annotations (see
``options.py`` for the shared ones) and add its line to :data:`COMMANDS`.  A command with
subcommands names a ``typer.Typer`` application instead of a function.  Rules of the house:

* a command's module imports only typer, its neighbours (``from .render import say``) and
  ``slipmargin.errors`` at its top; the function imports the front door (``import slipmargin as sm``),
  calls one function of it and delivers the result: no command computes or reaches behind the door;
* only the module of the command that was asked for is imported at all;
* a refusal is an :class:`~slipmargin.errors.InputError` (or ``NoSolution``, ``MotionStopped``),
  never a print and an exit; for an option use ``refuse("--step", problem, cure)``;
* a module that is not there yet leaves its command out of the list.

Exit status: 0 done; 1 a defect of ours, or ``check --strict`` of a motion that is not admissible;
2 bad input or usage, said in one line on stderr; 130 interrupted.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import logging
import os
import sys
import warnings
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import typer

from slipmargin import __version__
from slipmargin.errors import SlipmarginError
from slipmargin.notice import on_compile

from .examples import add_examples
from .render import finish_output, note_words, say_at_once, tell

#: Command → where its function (or typer application) is, and its one line in the list.
COMMANDS: dict[str, tuple[str, str]] = {
    "sweep": ("slipmargin_cli.sweep:sweep", "How hard it can push in each direction before a wheel slips."),
    "polytope": ("slipmargin_cli.polytope:polytope", "All forces and moments it can make: vertices, facets."),
    "bounds": ("slipmargin_cli.bounds:bounds", "Accelerations and cornering speeds that do not slip."),
    "explore": ("slipmargin_cli.explore:explore", "A local page with sliders: see the limits change."),
    "plan": ("slipmargin_cli.plan:plan", "The fastest way along a path with a margin against slip."),
    "check": ("slipmargin_cli.check:check", "Does a trajectory slip, where, and how much slower must it be?"),
    "simulate": ("slipmargin_cli.simulate:simulate", "What really happens under given wheel speeds."),
    "stop": ("slipmargin_cli.stop:stop", "Stopping distance and time by direction and speed."),
    "design": ("slipmargin_cli.design:design", "Which robot to build: every limit over varied dimensions."),
    "diagnose": ("slipmargin_cli.diagnose:diagnose", "What physics is missing, judged by measured runs."),
    "next-run": ("slipmargin_cli.next_run:next_run", "Which runs to drive next, and what they would decide."),
    "import": ("slipmargin_cli.import_logs:app", "Turn raw logs into a data set."),
    "monitor": ("slipmargin_cli.monitor:monitor", "Is a wheel slipping: live, by a likelihood ratio."),
    "export": (
        "slipmargin_cli.export:app",
        "A robot for other programs: a limiter in C, Gazebo's or MuJoCo's model.",
    ),
    "reproduce": ("slipmargin_cli.reproduce:reproduce", "Every published number beside ours."),
    "robots": ("slipmargin_cli.robots:app", "Robot files: list, show, new, from-urdf, check."),
    "surfaces": ("slipmargin_cli.surfaces:app", "Published friction coefficients: list, show."),
    "measure": ("slipmargin_cli.measure:measure", "Friction coefficients from pulls with a luggage scale."),
    "effects": ("slipmargin_cli.effects:app", "The effects a robot file may hold: list, show."),
}

#: The parser's base error, wherever this version of typer keeps it (BadParameter → UsageError → it).
_ParserError: type[Exception] = typer.BadParameter.__mro__[2]


def run() -> None:
    """Carry out what stands after ``slipmargin``; libraries' warnings are for those who ask for them."""
    if not sys.warnoptions and not os.environ.get("SLIPMARGIN_DEBUG"):
        warnings.simplefilter("ignore")
        logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where its cache is
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed before the program began
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8"))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal without φ is no reason to fail
    sys.exit(status(sys.argv[1:]))


def status(arguments: list[str]) -> int:
    """Carry out one command line; every failure is told here, and nowhere else.

    Returns
    -------
    int
        The exit status.
    """
    with _lost_interruptions() as lost:
        return _carried_out(arguments, lost)


@contextlib.contextmanager
def _lost_interruptions() -> Iterator[list[object]]:
    """Ctrl-C that came while LLVM called back into Python, which drops it there: filled as they come."""
    lost: list[object] = []
    tell_others = sys.unraisablehook

    def hear(dropped: Any) -> None:
        if issubclass(dropped.exc_type, KeyboardInterrupt):
            lost.append(dropped.exc_type)
        else:
            tell_others(dropped)

    sys.unraisablehook = hear
    try:
        yield lost
    finally:
        sys.unraisablehook = tell_others


def _carried_out(arguments: list[str], lost: list[object]) -> int:
    note_words(arguments)
    announce_compilation()
    try:
        command = typer.main.get_command(application(arguments))
        add_examples(command)
        code = command.main(arguments or ["--help"], prog_name="slipmargin", standalone_mode=False)
        return finish_output(code if isinstance(code, int) else 0)
    except SlipmarginError as fault:
        return tell(f"error: {' '.join(str(fault).split())}", 2)
    except _ParserError as fault:
        return tell(f"error: {_usage(fault)}", 2)
    except (KeyboardInterrupt, typer.Abort):
        return finish_output(130)
    except (OSError, MemoryError) as fault:
        if os.environ.get("SLIPMARGIN_DEBUG"):
            raise
        return tell(f"error: {_machine(fault)}", 2)
    except Exception as defect:
        if lost:  # what the compiler then lacks is no defect
            return finish_output(130)
        if os.environ.get("SLIPMARGIN_DEBUG"):
            raise
        return tell(
            f"internal error: {type(defect).__name__}: {' '.join(str(defect).split())[:300]} "
            "(a defect of slipmargin: run again with SLIPMARGIN_DEBUG=1 and report the traceback)",
            1,
        )


def announce_compilation() -> None:
    """On a terminal, say that the first run compiles: it takes some seconds in which nothing else is seen."""
    if sys.stderr.isatty():
        on_compile(lambda: say_at_once("compiling once, about 10 s"))


def application(arguments: list[str]) -> typer.Typer:
    """The application with the one command loaded that the arguments ask for, the others by name only."""
    app = typer.Typer(
        name="slipmargin",
        add_completion=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        callback=_top,
    )
    asked = next((word for word in arguments if not word.startswith("-")), None)
    completing = any(name.endswith("_COMPLETE") for name in os.environ)
    for name, (target, line) in COMMANDS.items():
        module, _, attribute = target.partition(":")
        if find_spec(module) is None:
            continue
        if name != asked and not completing:
            app.command(name, help=line)(_not_loaded)
            continue
        found = getattr(importlib.import_module(module), attribute)
        if isinstance(found, typer.Typer):
            app.add_typer(found, name=name, help=line)
        else:
            app.command(name)(found)
    return app


def _not_loaded() -> None:
    raise AssertionError("a command was run that had not been loaded")


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"slipmargin {__version__}")
        raise typer.Exit()


def _top(
    version: bool = typer.Option(
        False, "--version", callback=_version, is_eager=True, help="Print the version."
    ),
) -> None:
    """How hard a wheeled omnidirectional robot can push, turn and accelerate before a wheel slips.

    Wherever a command takes ROBOT it takes a robot file or the name of a built-in robot (slipmargin
    robots list).  Exit status: 0 done, 1 internal error (with check --strict: not admissible), 2 bad input
    or usage, 130 interrupted.
    """
    del version


def _machine(fault: OSError | MemoryError) -> str:
    """What the machine refused: place, what is wrong, what to do."""
    if isinstance(fault, MemoryError):
        return f"memory: there is not enough ({fault or 'none left'}), give less data or use a larger machine"
    place = fault.filename if isinstance(fault.filename, str) else "the machine"
    return f"{place}: {fault.strerror or fault}, make room or choose another place"


def _usage(fault: Any) -> str:
    """The parser's complaint in this program's one line: place, what is wrong, what to do."""
    context = getattr(fault, "ctx", None)
    path = context.command_path if context is not None else "slipmargin"
    parameter = getattr(fault, "param", None)
    options = [name for name in getattr(parameter, "opts", []) if name.startswith("-")]
    names = [
        getattr(parameter, "metavar", None),
        getattr(parameter, "name", None),
        getattr(fault, "option_name", None),
    ]
    name = options[-1] if options else next((str(n) for n in names if n), "")
    problem = " ".join(fault.format_message().split()).rstrip(".")
    if type(fault).__name__ == "MissingParameter":
        problem = "is missing"
    elif type(fault).__name__ == "NoSuchOption":
        guesses = " or ".join(getattr(fault, "possibilities", None) or ())
        problem = "is not an option" + (f", did you mean {guesses}?" if guesses else "")
    elif parameter is not None:
        problem = str(fault.message).rstrip(".")
    place = f"{name}: " if name else ""
    ends = "" if problem.endswith("?") else ","
    return " ".join(f"command line: {place}{problem}{ends} see {path} --help".split())
