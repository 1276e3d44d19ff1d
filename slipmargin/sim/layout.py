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
LOAD_ITERATES = 15  #: 1 where friction depends on a load that depends on the acceleration
BY_HEADING = 16  #: 1 where forces depend on the heading
BY_TIME = 17  #: 1 where friction or forces depend on time other than through wheel speeds
BY_VELOCITY = 18  #: 1 where the velocity derivative needs finite differences
BY_POSITION = 19  #: 1 where forces depend on the place
BY_ANGLE = 20  #: 1 where friction depends on the wheel angle other than by sectors
SHARE = 21  #: m g / N [N]
DELAY = 22  #: dead time of the drives [s]
DRIVEN = 23  #: 1 where commanded wheel speeds are states (droop, torque–speed line)
COMMANDS = 24  #: how many modulations of the commanded speed
COMMANDS_AT = 25
SLOWING = 26  #: 1 / no-load speed of the motor [s/rad], 0 where unknown
STALL_TORQUE = 27  #: [N m], 0 where unknown
LAGGED = 28  #: 1 where a command is not followed at once (lag, gain, delay, modulations)
LAW = 29  #: the friction law's number (physics/friction_laws.py)
LIFTED = 30  #: Σ of the loads at rest [N]
HEAD = 31

# --- a wheel ----------------------------------------------------------------------------------
ARM_X = 0  #: contact place from the centre of mass [m]
ARM_Y = 1
DRIVE_X = 2
DRIVE_Y = 3
GRIP_X = 4
GRIP_Y = 5
FREE_X = 6
FREE_Y = 7
RADIUS = 8  #: [m]
REST = 9  #: load at rest [N]
LOAD_X = 10  #: load per acceleration [kg]
LOAD_Y = 11
ROLLER_W = 12
ROLLER_T = 13
RIGID_W = 14
RIGID_T = 15
PITCH = 16  #: 2π / rollers [rad]
RIGID_SHARE = 17  #: share of a pitch that is rigid material
LAG = 18  #: [s]
GAIN = 19
DROOP = 20  #: [rad/(s N m)]
NO_SLIP_X = 21  #: body acceleration per wheel acceleration without slip [m]
NO_SLIP_Y = 22
NO_SLIP_W = 23
INERTIA_OF_WHEEL = 24  #: of the wheel with its motor, at the wheel [kg m²]
TILT_X = 25  #: load per height × external force [N per N m]
TILT_Y = 26
WHEEL = 27

# --- a term -----------------------------------------------------------------------------------
#: A modulation: variable, basis, target, count, shape a, shape b, N weights, count coefficients.
TERM = 6
#: A force: variable, basis, frame, count, shape a, shape b, height [m], lift [N], 3 × count coefficients.
FORCE = 8
