"""Does it really slip: contact law, motion, integration.

The fast road, for fitting::

    from slipmargin.sim.pack import pack, stack          # Model → flat array, several → rows
    from slipmargin.sim.signal import held, linear, hermite, angles
    from slipmargin.sim.batch import Batch

    batch = Batch([hermite(t, theta, omega), ...], [t, ...], commanded=False)   # once
    outcome = batch.run(pack(model), start_pose)         # (S, T, 3) poses; tens of thousands of times
    outcome = batch.run(stack([pack(m) for m in models]), start_pose, which=..., signal=...)

``start_pose`` (3,) or (R, 3); ``start_twist`` likewise (floor frame, rest by default).  Runs of
different length are padded with their last pose (``batch.lengths``).  ``outcome.ending`` is
:class:`~slipmargin.sim.batch.Ending` (0: done); a stopped run keeps its last pose, never NaN.
``commanded=True`` puts the model's actuators (lag, gain, delay, droop) between signal and wheel; lag,
gain and delay exactly, droop and the motors' torque–speed line by integrating the wheels as well, which is
slower.  Wheels start from ``spin_rad_s``, at rest by
default.  ``rtol`` 1e-6 (default) keeps poses to a few 1e-7 of their size on the paper's run, 1e-5 to a
few 1e-6 in about half the time: enough for a fit.

One run in full: :func:`slipmargin.sim.simulate.simulate`.  Pull test: :mod:`slipmargin.sim.pull`.  The
paper's runs: :mod:`slipmargin.paper.published`.  The slow second road: ``tests/oracles``.
"""
