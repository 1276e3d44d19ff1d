"""Where each number of a packed model stands: one flat float array a model.

A flat array can be stacked (many models, one call) and read by compiled code without objects.
Head (:data:`HEAD` numbers), then one block of :data:`WHEEL` numbers a wheel, then the friction
modulations, then the force terms.  Offsets are integers stored as floats (exact below 2⁵³).
"""

from __future__ import annotations

# --- head -------------------------------------------------------------------------------------
COUNT = 0  #: number of wheels N
MASS = 1  #: [kg]
INERTIA = 2  #: about the centre of mass [kg m²]
COM_X = 3  #: centre of mass in the body frame [m]
COM_Y = 4
STEEPNESS = 5  #: k of eq. (11) [s/m]
SHAPE = 6  #: 0 box, 1 disc-strip, 2 ellipse (physics/contact.py)
COUPLING = 7  #: share of the coupled law, 0 … 1
VISCOUS_W = 8  #: [N s/m] along ĝ
VISCOUS_T = 9  #: [N s/m] along f̂
MODULATIONS = 10  #: how many friction modulations
MODULATIONS_AT = 11  #: where the first begins
FORCES = 12  #: how many force terms
FORCES_AT = 13
LOAD_FOLLOWS = 14  #: 1 where loads depend on the acceleration
BY_LOAD = 15  #: 1 where friction depends on the load
BY_HEADING = 16  #: 1 where forces depend on the heading
BY_TIME = 17  #: 1 where friction or forces depend on time other than through wheel speeds
BY_VELOCITY = 18  #: 1 where the velocity derivative needs finite differences
BY_POSITION = 19  #: 1 where forces depend on the place
BY_ANGLE = 20  #: 1 where friction or rolling depends on the wheel angle other than by sectors
SHARE = 21  #: m g / N [N]
DELAY = 22  #: dead time of the drives [s]
DRIVEN = 23  #: 1 where commanded wheel speeds are states (droop, torque–speed line)
COMMANDS = 24  #: how many modulations of the commanded speed
COMMANDS_AT = 25
SLOWING = 26  #: 1 / no-load speed of the motor [s/rad], 0 where unknown
LAGGED = 27  #: 1 where a command is not followed at once (lag, gain, delay, ramp, modulations, a top speed)
LAW = 28  #: the friction law's number (physics/friction_laws.py)
LIFTED = 29  #: Σ of the loads at rest [N]
EDGES = 30  #: how many instants at which a term over time jumps or kinks
EDGES_AT = 31
PLAYS = 32  #: 1 where a wheel has play
RELIEFS = 33  #: how many ramps, ridges and bumps the floor has
RELIEFS_AT = 34
BY_HUB = 35  #: 1 where friction depends on the hub's velocity in a way whose derivative is analytic
BY_MOTION = 36  #: 1 where a force on the body depends on its velocity
RAMP = 37  #: time that a drive's command takes for a change of a radian per second [s²/rad], 0 without
BENT = 38  #: 1 where a wheel's speed is not in proportion to its command (modulations, a top speed)
HEAD = 39

# --- a wheel ----------------------------------------------------------------------------------
#: Sliding velocity along ĝ = the next four · (v_x, v_y, ω, wheel speed), of the centre of mass; likewise f̂.
GRIP_X = 0  #: ĝ
GRIP_Y = 1
GRIP_MOMENT = 2  #: of a unit force along ĝ about the centre of mass [m]
GRIP_ROLLS = 3  #: sliding along ĝ per wheel speed: radius × drive direction · ĝ [m]
FREE_X = 4
FREE_Y = 5
FREE_MOMENT = 6
FREE_ROLLS = 7
ROLLER_W = 8
ROLLER_T = 9
RIGID_W = 10
RIGID_T = 11
REST = 12  #: load at rest [N]
TILT_X = 13  #: load per height × external force [N per N m]
TILT_Y = 14
LOAD_X = 15  #: load per acceleration [kg]
LOAD_Y = 16
ARM_X = 17  #: contact place from the centre of mass [m]
ARM_Y = 18
RADIUS = 19  #: [m]
PITCH = 20  #: 2π / rollers [rad]
RIGID_SHARE = 21  #: share of a pitch that is rigid material
LAG = 22  #: [s]
GAIN = 23
DROOP = 24  #: [rad/(s N m)]
NO_SLIP_X = 25  #: body acceleration per wheel acceleration without slip [m]
NO_SLIP_Y = 26
NO_SLIP_W = 27
INERTIA_OF_WHEEL = 28  #: of the wheel with its motor, at the wheel [kg m²]
RUNOUT_COS = 29  #: the radius is ρ (1 + a cos θ + b sin θ): a [1]
RUNOUT_SIN = 30  #: b [1]
PLAY = 31  #: whole play between motor and wheel [rad]
WOBBLE_COS = 32  #: ĝ and f̂ are those below, turned by a cos θ + b sin θ: a [rad]
WOBBLE_SIN = 33  #: b [rad]
MEAN_GRIP_X = 34  #: ĝ of a wheel that does not wobble
MEAN_GRIP_Y = 35
MEAN_FREE_X = 36
MEAN_FREE_Y = 37
STALL_TORQUE = 38  #: of its motor [N m], 0 where unknown
TOP_SPEED = 39  #: that it reaches either way, commanded more [rad/s]; the largest number where unknown
WHEEL = 40

# --- a term -----------------------------------------------------------------------------------
#: A modulation: variable, basis, target, count, shape a, shape b, place (3), N weights, count coefficients.
PLACE = 6
TERM = 9
#: A force: variable, basis, frame, count, shape a, shape b, height [m], lift [N], place from the centre of
#: mass (2) [m], 3 × count coefficients.
FORCE = 10
#: A ramp, ridge or bump of the floor: profile, size, extent [m], edge [m], place (2).
RELIEF = 6
