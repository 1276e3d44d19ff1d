"""Where each number stands in the tables that a run works on."""

from __future__ import annotations

#: Columns of the contact table C (N, CONTACT): what is known of each wheel at one instant.
OMEGA, THETA, ALPHA, RIGID = 0, 1, 2, 3  #: ω [rad/s], θ [rad], ω̇ [rad/s²], 1 on rigid material
SLIP_W, SLIP_T = 4, 5  #: sliding velocity along ĝ, f̂ [m/s]
FORCE_W, FORCE_T = 6, 7  #: f_W, f_T per unit of load [1]
LOAD, STILL = 8, 9  #: the load, and what it would be without acceleration [N]
WW, WT, TT = 10, 11, 12  #: slopes of the law, f_W over u_T being that of f_T over u_W [s/m]
MU_W, MU_T, K_W, K_T = 13, 14, 15, 16  #: coefficients [1] and slopes of the law [s/m] in force now
GROW_W, GROW_T = 17, 18  #: derivatives of the force [N] along ĝ, f̂, while slopes are taken
BY_TORQUE, BY_SPEED = 19, 20  #: derivatives of a driven wheel's acceleration
ROUND = 21  #: radius at this angle over the mean radius [1]
AIR = 22  #: while wheels hang in the air: 1 for those
SHARED, SHARED_X, SHARED_Y = (
    23,
    24,
    25,
)  #: and what each carries without acceleration [N], per acceleration [kg]
HUNG = 26  #: AIR at the step before
RISE_X, RISE_Y, RISE_M = 27, 28, 29  #: slope of the floor under the wheel, body axes [1], and its moment [m]
#: Derivatives of f_W and of f_T over the hub's velocity (2) and over u_W, by what friction makes of these,
#: while slopes are taken [s/m].
PASS_W, PASS_T = 30, 33
CONTACT = 36
#: Entries of the body table B: external push in the floor frame (3) and its height, inverse of the mass
#: matrix of a (2 × 2 row by row), yaw moment per acceleration that loads bring about, factors of a
#: wheel (6), external wrench in the body frame (3), its moment h F (2), lift, wheels in the air and the pull
#: on one that would keep the robot upright [N], 1 where no acceleration agrees with its own loads, 1 while
#: loads stay as they are at rest; while slopes are taken, what wrench and h F change by with each of v_x,
#: v_y and ω (5 each).
PUSH, INVERSE, LEVER, FACTORS, WRENCH, TILTING, LIFT, UP, PULLED = 0, 4, 8, 10, 16, 19, 21, 22, 23
JAMMED, RESTING, DRAGS = 24, 25, 26
BODY = 41
