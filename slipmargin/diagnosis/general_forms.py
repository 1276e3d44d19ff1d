"""The list of general forms: one or more for every variable a residual may depend on.

Those of friction and forces are written here, those of commands and camera in ``signal_forms.py``.
"""

from __future__ import annotations

import numpy as np

from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.forms import Ranges, forces, friction
from slipmargin.diagnosis.signal_forms import actuation_forms, measurement_forms
from slipmargin.effects import Trace
from slipmargin.model import Model
from slipmargin.physics.sectors import pitch
from slipmargin.physics.variables import Basis, Frame, Target, Variable


def general_candidates(model: Model, ranges: Ranges, commanded: bool) -> list[Candidate]:
    """One or more general forms for every variable of :class:`~slipmargin.effects.Trace`."""
    found = [
        *_over_contact(model, ranges),
        *_over_motion(model, ranges),
        *_over_place(model, ranges),
        *measurement_forms(ranges),
    ]
    return found + (actuation_forms(model, ranges) if commanded else [])


def _over_contact(model: Model, r: Ranges) -> list[Candidate]:
    period = pitch(float(model.grip.rollers[0]))
    drive, transverse, both, stiff = Target.DRIVE, Target.TRANSVERSE, Target.BOTH, Target.STIFFNESS
    angle, slip = Variable.WHEEL_ANGLE, Variable.SLIP_SPEED
    one = np.eye(model.count)
    turn = (2.0 * np.pi, 0.0)
    quarter = (0.0, np.pi / 2.0)
    scales = [f * r.slip_m_s for f in (0.03, 0.1, 0.3, 1.0)]
    unity, constant, none = Variable.UNITY, Basis.CONSTANT, (1.0, 0.0)
    return [
        friction(
            Trace.WHEEL_ANGLE,
            "roller pitch",
            model,
            [(angle, Basis.FOURIER, (period, 0.0), 6, t, None) for t in (drive, transverse)],
        ),
        friction(
            Trace.WHEEL_ANGLE,
            "up to four times a turn",
            model,
            [(angle, Basis.FOURIER, turn, 8, both, row) for row in one],
        ),
        friction(
            Trace.SLIP_SPEED,
            "both directions",
            model,
            [(slip, Basis.DECAY, (s, 1.0), 1, both, None) for s in scales],
        ),
        friction(
            Trace.SLIP_SPEED,
            "each direction",
            model,
            [(slip, Basis.DECAY, (s, 1.0), 1, t, None) for s in scales for t in (drive, transverse)],
        ),
        friction(Trace.SLIP_SPEED, "curve", model, [(slip, Basis.HATS, (0.0, r.slip_m_s), 8, both, None)]),
        friction(
            Trace.SLIP_COUPLING,
            "slip angle",
            model,
            [(Variable.SLIP_ANGLE, Basis.HATS, quarter, 5, t, None) for t in (drive, transverse)],
        ),
        friction(
            Trace.SLIP_RATIO,
            "creep stiffness",
            model,
            [
                (Variable.ROLLING_SPEED, Basis.DECAY, (s * r.speed_m_s, 1.0), 1, stiff, None)
                for s in (0.05, 0.2, 0.8)
            ]
            + [(unity, constant, none, 1, stiff, None)],
            bound=100.0,
        ),
        friction(
            Trace.SLIP_RATIO,
            "friction over ratio",
            model,
            [(Variable.SLIP_RATIO, Basis.DECAY, (s, 1.0), 1, both, None) for s in (0.03, 0.1, 0.3, 1.0)],
        ),
        friction(
            Trace.SLIP_RATIO,
            "curve over ratio",
            model,
            [(Variable.SLIP_RATIO, Basis.HATS, (0.0, 1.5), 7, both, None)],
        ),
        friction(
            Trace.COEFFICIENT,
            "coefficients and steepness",
            model,
            [(unity, constant, none, 1, t, None) for t in (drive, transverse)]
            + [(unity, constant, none, 1, stiff, None)],
            bound=20.0,
        ),
        *[
            friction(
                Trace.WHEEL,
                f"friction of wheel {name}",
                model,
                [(unity, constant, none, 1, t, row) for t in (drive, transverse)],
            )
            for name, row in zip(model.geometry.names, one, strict=True)
        ],
        friction(
            Trace.WHEEL_LOAD,
            "friction over load",
            model,
            [(Variable.WHEEL_LOAD, Basis.POLYNOMIAL, (1.0, 0.0), 2, both, None)],
        ),
    ]


def _over_motion(model: Model, r: Ranges) -> list[Candidate]:
    v, w, a = r.speed_m_s, r.yaw_rate_rad_s, r.acceleration_m_s2
    along = [(Variable.VELOCITY_X, v, 0), (Variable.VELOCITY_Y, v, 1), (Variable.YAW_RATE, w, 2)]
    slow = 0.02
    asked = [
        (Variable.ACCELERATION_X, a),
        (Variable.ACCELERATION_Y, a),
        (Variable.YAW_ACCELERATION, a / max(v, 1e-9) * max(w, 1e-9)),
    ]
    return [
        forces(
            Trace.VELOCITY,
            "force along each velocity",
            model,
            Frame.BODY,
            [
                (variable, Basis.ODD, (slow * size, 0.0), 3, (axis,), max(1.0, size))
                for variable, size, axis in along
            ],
        ),
        forces(
            Trace.VELOCITY,
            "force across the velocity",
            model,
            Frame.BODY,
            [(variable, Basis.POLYNOMIAL, (size, 0.0), 2, (0, 1, 2), 1.0) for variable, size, _ in along],
        ),
        friction(
            Trace.VELOCITY,
            "friction over speed",
            model,
            [(Variable.SPEED, Basis.HATS, (0.0, v), 5, Target.BOTH, None)],
        ),
        friction(
            Trace.VELOCITY,
            "friction over yaw rate",
            model,
            [(Variable.YAW_RATE, Basis.HATS, (-w, w), 7, Target.BOTH, None)],
        ),
        forces(
            Trace.ACCELERATION,
            "force with acceleration",
            model,
            Frame.BODY,
            [(variable, Basis.POLYNOMIAL, (size, 0.0), 1, (0, 1, 2), 1.0) for variable, size in asked],
        ),
        friction(
            Trace.ACCELERATION,
            "friction of each wheel with acceleration",
            model,
            [
                (variable, Basis.POLYNOMIAL, (size, 0.0), 1, Target.BOTH, row)
                for variable, size in asked[:2]
                for row in np.eye(model.count)
            ],
        ),
    ]


def _over_place(model: Model, r: Ranges) -> list[Candidate]:
    turn = (2.0 * np.pi, 0.0)
    clock = (0.0, r.duration_s)
    place = [
        (v, (middle - r.position_m, middle + r.position_m))
        for v, middle in zip((Variable.POSITION_X, Variable.POSITION_Y), r.middle_m, strict=True)
    ]
    floor, both = Frame.FLOOR, Target.BOTH
    return [
        friction(
            Trace.HEADING,
            "friction over heading",
            model,
            [(Variable.HEADING, Basis.FOURIER, turn, 4, both, None)],
        ),
        friction(
            Trace.HEADING,
            "friction over sliding direction",
            model,
            [(Variable.SLIP_HEADING, Basis.FOURIER, turn, 8, both, None)],
        ),
        friction(
            Trace.HEADING,
            "friction over the direction of the whole slip",
            model,
            [(Variable.SLIP_DIRECTION, Basis.FOURIER, turn, 8, both, None)],
        ),
        forces(
            Trace.HEADING,
            "force over heading",
            model,
            floor,
            [(Variable.HEADING, Basis.FOURIER, turn, 4, (0, 1, 2), 1.0)],
        ),
        forces(
            Trace.POSITION,
            "force over position",
            model,
            floor,
            [(v, Basis.HATS, across, 5, (0, 1), 1.0) for v, across in place]
            + [(v, Basis.HATS, across, 2, (2,), 1.0) for v, across in place],
        ),
        friction(
            Trace.POSITION,
            "friction over position",
            model,
            [(v, Basis.HATS, across, 9, both, None) for v, across in place],
        ),
        friction(
            Trace.TIME, "friction over time", model, [(Variable.TIME, Basis.HATS, clock, 7, both, None)]
        ),
        friction(
            Trace.TIME,
            "friction that settles",
            model,
            [(Variable.TIME, Basis.DECAY, (s * r.duration_s, 1.0), 1, both, None) for s in (0.15, 0.6)],
        ),
        forces(
            Trace.TIME,
            "force over time",
            model,
            floor,
            [(Variable.TIME, Basis.HATS, clock, 7, (0, 1, 2), 1.0)],
        ),
        forces(
            Trace.CONSTANT_FORCE,
            "constant in the floor frame",
            model,
            floor,
            [(Variable.UNITY, Basis.CONSTANT, (1.0, 0.0), 1, (0, 1, 2), 1.0)],
        ),
        forces(
            Trace.CONSTANT_FORCE,
            "constant in the body frame",
            model,
            Frame.BODY,
            [(Variable.UNITY, Basis.CONSTANT, (1.0, 0.0), 1, (0, 1, 2), 1.0)],
        ),
    ]
