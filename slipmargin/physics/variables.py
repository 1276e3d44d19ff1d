"""What friction and forces may depend on, and the basis functions they may depend by.

Both are data: an effect is written as coefficients in a basis over a variable, and one fixed
kernel (:mod:`slipmargin.sim.motion`) evaluates all of them.
"""

from __future__ import annotations

from enum import IntEnum


class Variable(IntEnum):
    """A quantity the simulator knows at every instant (per wheel where it says so)."""

    UNITY = 0  #: the constant 1
    WHEEL_ANGLE = 1  #: θ_i [rad], per wheel
    WHEEL_LOAD = 2  #: N_i / (m g / n) − 1 [1], per wheel; departure from an equal share
    SLIP_SPEED = 3  #: |u_i·ĝ_i| or |u_i·f̂_i| [m/s], per wheel, the component of the target direction
    SLIP_RATIO = 4  #: SLIP_SPEED / (ROLLING_SPEED + 1 mm/s) [1], per wheel
    SLIP_ANGLE = 5  #: atan2(|u_i·f̂_i|, |u_i·ĝ_i|) [rad], per wheel: 0 pure drive slip, π/2 pure transverse
    ROLLING_SPEED = 6  #: max(|hub velocity|, |ρ_i θ̇_i|) [m/s], per wheel
    VELOCITY_X = 7  #: body-frame velocity of the origin along the body's x [m/s]
    VELOCITY_Y = 8  #: body-frame velocity of the origin along the body's y [m/s]
    YAW_RATE = 9  #: φ̇ [rad/s]
    SPEED = 10  #: |velocity of the origin| [m/s]
    ACCELERATION_X = 11  #: no-slip body acceleration asked by the wheels along x [m/s²]
    ACCELERATION_Y = 12  #: no-slip body acceleration asked by the wheels along y [m/s²]
    YAW_ACCELERATION = 13  #: no-slip yaw acceleration asked by the wheels [rad/s²]
    HEADING = 14  #: φ [rad]
    POSITION_X = 15  #: x in the floor frame [m]
    POSITION_Y = 16  #: y in the floor frame [m]
    TIME = 17  #: time since the start of the run [s]
    SLIP_HEADING = 18  #: floor-frame direction of the slip component [rad], per wheel: φ + arg ĝ_i
    #: (or f̂_i), plus π where the component is negative
    COMMAND_SPEED = 19  #: |ω_cmd,i| [rad/s], per wheel; only for transients
    HUB_SPEED = 20  #: |hub velocity| [m/s], per wheel: how fast the floor passes under it
    PASSING_SPEED = 21  #: |hub velocity − w u_W ĝ| [m/s], per wheel: how fast floor and tread pass the
    #: contact, w the tread's share (``place[0]`` of its term): 0 the floor alone, ½ the mean of both
    FROM_PLACE = 22  #: distance of the contact from the term's place on the floor [m], per wheel
    BEFORE_LINE = 23  #: how far the contact lies before the line through the term's place, whose normal
    #: points ``place[2]`` [rad] [m], per wheel; negative beyond it
    SLIP_DIRECTION = 24  #: floor-frame direction of the whole slip [rad], per wheel: φ + arg(u_W ĝ + u_T f̂)


class Basis(IntEnum):
    """A family of functions of one variable v; ``shape`` holds its two constants (a, b)."""

    CONSTANT = 0  #: 1
    POLYNOMIAL = 1  #: (v/a)^j, j = 1, 2, …; a: scale
    FOURIER = 2  #: cos(2π j v/a), sin(2π j v/a), j = 1, 2, …; a: period
    HATS = 3  #: piecewise linear through equidistant knots from a to b, one coefficient a knot
    DECAY = 4  #: exp(−(v/a)^b) − 1; a: scale, b: exponent
    RECIPROCAL = 5  #: a/(v + b) − 1
    WINDOW = 6  #: 1 for a ≤ v < b, else 0
    ODD = 7  #: (2/π) atan(v/a), then v|v|^(j−1) for j = 1, 2, …; a: speed scale
    STEP = 8  #: 1 far below a, 0 far above: (1 − tanh((v − a)/2b))/2; b: width of the edge
    LOBE = 9  #: 1/(1 + (sin((v − a)/2)/sin(b/4))³²): 1 over an arc b [rad] around the angle a, else 0


class Target(IntEnum):
    """What a modulation multiplies."""

    DRIVE = 0  #: the coefficient along ĝ
    TRANSVERSE = 1  #: the coefficient along f̂
    BOTH = 2  #: both coefficients (the same as the wheel's load)
    STIFFNESS = 3  #: the steepness k of eq. (11)
    STIFFNESS_DRIVE = 4  #: the steepness along ĝ only
    STIFFNESS_TRANSVERSE = 5  #: the steepness along f̂ only


class Frame(IntEnum):
    """Where the axes of a force point."""

    BODY = 0  #: body x, body y, yaw moment
    FLOOR = 1  #: floor x, floor y, yaw moment
    AGAINST_MOTION = 2  #: against the velocity, to the left of it, against the yaw rate
    AT_PLACE = 3  #: the same with the velocity of a place of the body, where the force acts
