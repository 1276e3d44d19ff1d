"""Failures that are sentences: where, what is wrong, what to do.

Every exception the package raises on purpose derives from :class:`SlipmarginError`, so the
command line can tell a refused input (exit status 2) from a defect of its own (exit status 1).
"""

from __future__ import annotations

from typing import final


class SlipmarginError(Exception):
    """Anything the package refuses to do, said in one sentence with a cure."""


@final
class InputError(SlipmarginError):
    """Input that cannot be used: names the place, the problem and the cure.

    Parameters
    ----------
    place : str
        Key, column or ``line:column`` that holds the fault, e.g. ``wheel[2].radius_m``.
    problem : str
        What is wrong, with the offending value.
    cure : str
        What to write instead.
    source : str, optional
        File (or command line) that holds the place; filled in by the reader.
    """

    def __init__(self, place: str, problem: str, cure: str, source: str = "") -> None:
        self.place, self.problem, self.cure, self.source = place, problem, cure, source
        super().__init__(str(self))

    def __str__(self) -> str:
        text = ": ".join(part for part in (self.source, self.place, f"{self.problem}, {self.cure}") if part)
        return " ".join(text.split())  # one line, whatever the value contained

    def within(self, prefix: str) -> InputError:
        """The same fault seen from outside: its place prefixed by ``prefix``."""
        place = f"{prefix}.{self.place}" if self.place and prefix else prefix or self.place
        return InputError(place, self.problem, self.cure, self.source)

    def in_file(self, source: str) -> InputError:
        """The same fault with the file it was read from."""
        return InputError(self.place, self.problem, self.cure, source)


@final
class NoSolution(SlipmarginError):
    """A program that has no answer; carries the evidence.

    Parameters
    ----------
    what : str
        What was asked for.
    why : str
        The solver's verdict in words.
    cure : str
        What would make it possible.
    evidence : object, optional
        Program, solution or place that shows it.
    """

    def __init__(self, what: str, why: str, cure: str, evidence: object = None) -> None:
        self.evidence = evidence
        super().__init__(what, why, cure)

    def __str__(self) -> str:
        return "{}: {}, {}".format(*self.args)


@final
class MotionStopped(SlipmarginError):
    """A simulation that cannot go on (the robot tips, a value overflows): the time, the reason, the cure."""

    def __init__(self, time_s: float, why: str, cure: str) -> None:
        self.time_s, self.why, self.cure = time_s, why, cure
        super().__init__(f"motion stopped at t = {time_s:.6g} s: {why}, {cure}")
