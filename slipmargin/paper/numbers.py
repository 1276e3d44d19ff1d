"""Every number and every checkable claim of the paper, each with the words it was read in.

Source of all: R. L. Williams II, B. E. Carter, P. Gallina, G. Rosati, "Dynamic Model with Slip for Wheeled
Omni-Directional Robots", IEEE Transactions on Robotics and Automation 18(3), 2002.  ``where`` names the
section (the text at hand has no page numbers), ``quote`` is verbatim.  The points drawn in the figures are
not in the text, so none is quoted.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import final


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Published:
    """One number or claim as printed.

    Attributes
    ----------
    printed : str
        The number as it stands in ``quote`` ("14", "-0.016"); empty for a claim in words.
    exponent : int
        Power of ten that takes the printed number to ``unit``: -3 for millimetres.
    figure : str
        File of the figure that shows it, empty where none does.
    """

    key: str
    what: str
    unit: str
    where: str
    quote: str
    printed: str = ""
    exponent: int = 0
    figure: str = ""

    @property
    def value(self) -> float | None:
        """The printed number in SI units, or None for a claim in words."""
        return float(Decimal(self.printed).scaleb(self.exponent)) if self.printed else None

    @property
    def half_digit(self) -> float:
        """Half a unit of the last printed digit, in SI units; 0 for a claim in words."""
        if not self.printed:
            return 0.0
        step = Decimal(1).scaleb(self.exponent + min(0, int(Decimal(self.printed).as_tuple().exponent)))
        return float(step / 2)


def _number(
    key: str, what: str, unit: str, printed: str, quote: str, where: str, figure: str = "", exponent: int = 0
) -> Published:
    return Published(
        key=key,
        what=what,
        unit=unit,
        printed=printed,
        quote=quote,
        where=where,
        figure=figure,
        exponent=exponent,
    )


def _claim(key: str, what: str, unit: str, quote: str, where: str, figure: str = "") -> Published:
    return Published(key=key, what=what, unit=unit, quote=quote, where=where, figure=figure)


_MU = "section III.A.2 and Table I"
_TABLE = "section IV.A, Table I"
_MOTION, _INITIAL, _IMPROVED = "section III.B", "section III.B.1", "section IV.C"
_END = "ϕ drifts from its commanded value of zero by -0.111 rad in the worst case at the end"
_PAPER_ROW, _CARPET_ROW = "Paper\t0.26\t0.09\t0.47\t0.47", "Carpet\t0.25\t0.15\t0.56\t0.56"
_MEASURED = "measured experimental values of 0.524, 0.506, and 0.489 rad"

# fmt: off
#: Every printed number, in the order of the text.
NUMBERS: tuple[Published, ...] = (
    _number("rollers", "rollers of a wheel", "1", "8", "wheel contains $n=8$ rollers",
        "section III.A, Fig. 5"),
    _number("regularisation_slope", "k of eq. (11)", "s/m", "1000", "We chose $k=1000$ by eye",
        "section III.A.1"),
    _number("paper_roller_drive", "paper: μ'_W", "1", "0.26", _PAPER_ROW, _MU),
    _number("paper_roller_transverse", "paper: μ'_T", "1", "0.09", _PAPER_ROW, _MU),
    _number("carpet_roller_drive", "carpet: μ'_W", "1", "0.25", _CARPET_ROW, _MU),
    _number("carpet_roller_transverse", "carpet: μ'_T", "1", "0.15", _CARPET_ROW, _MU),
    _number("goal_x", "commanded distance along X", "m", "0.4",
        "final point $\\mathbf{X}_F = \\{0.4 \\ 0.0 \\ 0\\}^T$ (m)", _MOTION),
    _number("duration", "commanded duration", "s", "3.5", "specified time of $t_F = 3.5$ sec", _MOTION),
    _number("delta", "front wheels' angle δ", "deg", "15", "our design has $\\delta = 15^\\circ$",
        f"{_MOTION}, Fig. 3"),
    _number("delta_preferable", "angle δ of the symmetric layout", "deg", "30",
        "$\\delta = 30^\\circ$ is preferable for robot symmetry", _MOTION, "fig8"),
    _number("omega_1", "wheel speed of wheels 1 and 2", "rad/s", "1.16",
        "$\\dot{\\theta}_1 = \\dot{\\theta}_2 = +1.16$", _MOTION),
    _number("omega_3", "wheel speed of wheel 3", "rad/s", "-4.50", "$\\dot{\\theta}_3 = -4.50$ (rad/s)",
        _MOTION),
    _number("initial_paper_x_short", "initial model, paper: x short of 0.4 m", "m", "14",
        "x falls short by 14 mm its goal of 0.4 m", f"{_INITIAL}, Fig. 6a", "fig6", -3),
    _number("initial_paper_x_short_at_stop", "initial model, paper: x short of 0.4 m at t = 3.5 s", "m", "14",
        "x falls short by 14 mm its goal of 0.4 m", f"{_INITIAL}, Fig. 6a", "fig6", -3),
    _number("initial_paper_y", "initial model, paper: y", "m", "-9", "y drifts -9 mm from the desired zero",
        f"{_INITIAL}, Fig. 6a", "fig6", -3),
    _number("initial_paper_phi", "initial model, paper: φ", "rad", "-0.016",
        "ϕ drifts from its commanded value of zero by -0.016 rad at the end", f"{_INITIAL}, Fig. 6a", "fig6"),
    _number("initial_paper_steady_from", "initial model, paper: x is linear in time from", "s", "0.25",
        "From approximately $t = 0.25$ sec to $t = t_F = 3.5$ sec, the x motion is linear",
        f"{_INITIAL}, Fig. 6a", "fig6"),
    _number("roller_share", "roller share of a sector", "1", "90", "accounts for 90% of each angular sector",
        "section IV.A", exponent=-2),
    _number("rigid_share", "rigid share of a sector", "1", "10", "(the rigid material) accounts for 10%",
        "section IV.A", exponent=-2),
    _number("paper_rigid_drive", "paper: μ''_W", "1", "0.47", _PAPER_ROW, _TABLE),
    _number("paper_rigid_transverse", "paper: μ''_T", "1", "0.47", _PAPER_ROW, _TABLE),
    _number("carpet_rigid_drive", "carpet: μ''_W", "1", "0.56", _CARPET_ROW, _TABLE),
    _number("carpet_rigid_transverse", "carpet: μ''_T", "1", "0.56", _CARPET_ROW, _TABLE),
    _number("improved_paper_x_short", "improved model, paper: x short of 0.4 m", "m", "53",
        "x falls short by 53 mm its goal of 0.4 m", f"{_IMPROVED}, Fig. 9a", "fig9", -3),
    _number("improved_paper_y", "improved model, paper: y", "m", "-22",
        "y drifts -22 mm from the desired zero", f"{_IMPROVED}, Fig. 9a", "fig9", -3),
    _number("improved_paper_phi", "improved model, paper: φ", "rad", "-0.111",
        "the simulated (improved friction model) ending value of ϕ is -0.111 rad", f"{_IMPROVED}, Fig. 9a",
        "fig9"),
    _number("improved_paper_phi_worst", "improved model, paper: the worst φ, said to be at the end", "rad",
        "-0.111", _END, f"{_IMPROVED}, Fig. 9a", "fig9"),
    _number("improved_carpet_phi", "improved model, carpet: φ", "rad", "0.558",
        "the simulated ending value of ϕ is 0.558 rad", f"{_IMPROVED}, Fig. 10b", "fig10"),
    *(
        _number(
            f"measured_carpet_phi_{k}",
            f"carpet: φ measured in trial {k}",
            "rad",
            value,
            _MEASURED,
            f"{_IMPROVED}, Fig. 10b",
            "fig10",
        )
        for k, value in enumerate(("0.524", "0.506", "0.489"), start=1)
    ),
)

_ALIKE = "sliding speeds for wheels one and two are identical due to symmetry"

#: Every claim in words that a computation can decide, or that only the authors' measurements could.
CLAIMS: tuple[Published, ...] = (
    _claim("equal_loads", "wheel 3 carries m g/3 with the centre of mass at the centre: its share by statics",
        "m g", "we assume the vehicle weight is equally distributed on each wheel",
        "section III.A.1, eq. (8)"),
    _claim("transverse_smaller",
        "rollers grip less along the axle: μ'_T/μ'_W, the larger of the two surfaces", "1",
        "the transverse roller friction ($\\dot{\\mu}_{T \\max}$) is much smaller", _TABLE),
    _claim("rollers_alike", "rollers grip alike on both surfaces: μ'_W of carpet over paper", "1",
        "are nearly the same for paper and carpet", _TABLE),
    _claim("rigid_higher_on_carpet", "rigid material grips better on carpet: μ'' of carpet over paper", "1",
        "the carpet friction coefficient value is higher than that of the paper surface", _TABLE),
    _claim("rigid_same_both_ways", "rigid material grips the same both ways: largest |μ''_W − μ''_T|", "1",
        "are identical for the material between the rollers", _TABLE),
    _claim("sector_adds_up", "roller and rigid part make the sector 2π/n: their sum over it", "1",
        "$\\Delta\\theta' + \\Delta\\theta'' = 2\\pi/n$", "section IV.A, Fig. 5"),
    _claim("y_less_severe_initial", "initial model, paper, the same run along Y: y short of 0.4 m", "m",
        "Y motion is inherently less affected by slip", f"{_MOTION}; again in section V"),
    _claim("y_less_severe_improved", "improved model, paper, the same run along Y: y short of 0.4 m", "m",
        "slipping for Y translational motions are not as severe", f"section V; again in {_MOTION}"),
    _claim("smoother_commands_slip_less",
        "initial model, paper: x short of 0.4 m when the speed follows a 5th-order polynomial", "m",
        "we need smoother trajectory generation, perhaps using 5th-order polynomials", _MOTION),
    _claim("initial_slip_at_start_and_end",
        "initial model, paper: largest drive slip within 50 ms of the start and of the stop, the lesser",
        "m/s", "slipping is encountered at the start and end of motion", f"{_INITIAL}, Fig. 6b", "fig6"),
    _claim("initial_no_slip_in_the_middle", "initial model, paper: largest drive slip from 0.3 s to 3.5 s",
        "m/s", "but not in the middle", f"{_INITIAL}, Fig. 6b", "fig6"),
    _claim("initial_phi_larger_in_mid_motion", "initial model, paper: the largest φ on the way", "rad",
        "in the middle of motion, the ϕ drift is larger", f"{_INITIAL}, Fig. 6a", "fig6"),
    _claim("initial_wheels_1_and_2_alike", "initial model, paper: largest |v_W1 − v_W2|", "m/s", _ALIKE,
        f"{_INITIAL}, Fig. 6b", "fig6"),
    _claim("initial_carpet_x_short", "initial model, carpet: x short of 0.4 m", "m",
        "the simulated result using the initial friction model and the carpet motion surface",
        "section III.B.2, Fig. 7b", "fig7"),
    _claim("initial_disagrees_on_carpet",
        "initial model, carpet: |φ| at the end beside 0.506 rad measured (mean of three)", "rad",
        "the initial simulation results do not agree well with the experimental results",
        "section IV, Figs 7a and 7b", "fig7"),
    _claim("fig8_polytope", "vertices of the set of forces and moments at δ = 15°, a zonotope", "1",
        "is a polytope that represents the maximum force available", "section IV.B, eq. (17)", "fig8"),
    _claim("fig8_depends_on_orientation", "paper, rollers: strongest orientation over weakest", "1",
        "is a function of ϕ", "section IV.B, eq. (18)", "fig8"),
    _claim("fig8_quarter_turn_suffices",
        "largest relative change of F_emax when φ is mirrored or turned by half a turn", "1",
        "plotting results from 0 to $\\pi/2$ rad in robot orientation is sufficient", "section IV.B, Fig. 8",
        "fig8"),
    _claim("fig8_agreement", "measured pulls and theory", "N", "compare reasonably well",
        "section IV.B, Fig. 8", "fig8"),
    _claim("fig8_repeatability", "paper, φ = 0: F_emax with all wheels on rigid material over all on rollers",
        "1", "the experimental repeatability is very low", "section IV.B, Fig. 8", "fig8"),
    _claim("improved_slip_at_start_and_end",
        "improved model, paper: largest drive slip within 50 ms of the start and of the stop, the lesser",
        "m/s", "slipping again is encountered at the start and end of motion", f"{_IMPROVED}, Fig. 9b",
        "fig9"),
    _claim("improved_wheels_1_and_2_alike", "improved model, paper: largest |v_W1 − v_W2|", "m/s", _ALIKE,
        f"{_IMPROVED}, Fig. 9b", "fig9"),
    _claim("improved_wheel_3_slips_in_mid_motion",
        "improved model, paper: largest slip of wheel 3 from 0.8 s to 3.4 s", "m/s",
        "wheel three experiences significant slip during the middle of the motion", f"{_IMPROVED}, Fig. 9b",
        "fig9"),
    _claim("improved_drifts_larger",
        "paper: improved over initial, the least of the three ratios x short, y, φ", "1",
        "All three Cartesian drifts are much larger than predicted in Fig. 6a",
        f"{_IMPROVED}, Figs 6a and 9a", "fig9"),
    _claim("improved_carpet_x_short", "improved model, carpet: x short of 0.4 m", "m",
        "the simulated result using the improved friction model and the carpet motion surface",
        f"{_IMPROVED}, Fig. 10b", "fig10"),
    _claim("improved_agrees_better", "end points, improved beside initial model", "m",
        "is much better than that displayed in Figs. 7a and b", f"{_IMPROVED}, Figs 7 and 10", "fig10"),
    _claim("improved_carpet_phi_compares", "improved model, carpet: φ minus the mean of the measured three",
        "rad", "which compares favorably with the measured experimental values", f"{_IMPROVED}, Fig. 10b",
        "fig10"),
    _claim("paper_phi_very_small", "improved model, paper: φ beside four measured ones that are not printed",
        "rad",
        "the four experimental trials all ended with very small ϕ close to the angular measurement precision",
        f"{_IMPROVED}, Fig. 10a", "fig10"),
    _claim("kinetic_friction_might_help", "a lower coefficient of dynamic friction", "1",
        "use of a combined friction coefficient model where the dynamic friction is less", _IMPROVED),
    _claim("rigid_matters_at_low_rates",
        "paper, the run ten times slower: x short, improved minus initial model", "m",
        "is the rigid material between rollers, even at low motion rates and accelerations",
        "section V; also the abstract"),
)

# fmt: on
#: Everything by its key.
BY_KEY = {p.key: p for p in (*NUMBERS, *CLAIMS)}
#: Final headings measured on carpet, three trials (section IV.C); data, not computed here [rad].
MEASURED_CARPET_PHI_RAD = tuple(
    p.value for p in NUMBERS if p.key.startswith("measured_") and p.value is not None
)


def published(key: str) -> float:
    """The printed number of this key in SI units; KeyError or ValueError where there is none."""
    value = BY_KEY[key].value
    if value is None:
        raise ValueError(f"{key} is a claim in words")
    return value
