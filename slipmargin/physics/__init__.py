"""The equations that every room shares, each written once.

Limits, paths, the simulator and the diagnosis read them here and restate none.  Functions on numbers
work on NumPy arrays and on plain numbers alike, so that the simulator compiles these very functions
(:mod:`slipmargin.physics.compiled`).

===================  =====================================================================
``frames``           rotations between floor and body, velocity of a point of the body
``kinematics``       wheel geometry: no-slip map, hub and lateral slip rows, wrench maps
``friction_laws``    share of the grip used at a slip: force, slope, potential, inverse
``grips``            the set a wheel's friction force lies in: box, disc and strip, ellipse
``loads``            wheel loads, affine in acceleration and external wrench
``sectors``          which part of a wheel touches the floor: a roller or rigid material
``variables``        what friction and forces may depend on, and the basis functions
``terms``            friction multipliers and force terms as data
``constants``        gravity, and the speeds below which a direction fades out
===================  =====================================================================
"""
