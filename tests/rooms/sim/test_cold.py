"""The first run after installation: what the second process compiles is what the kernel asks for."""

from __future__ import annotations

import numpy as np

from slipmargin.paper.published import straight_line
from slipmargin.sim import cold, motion


def test_the_kernel_is_compiled_for_the_arguments_it_gets() -> None:
    straight_line("paper", improved=True, samples=3)
    assert motion.run.signatures == [cold._KERNEL]


def test_the_parts_are_compiled_for_the_arguments_they_get() -> None:
    # compile_apart finds nothing to do: every part is in the cache under the very types it is listed with
    run = straight_line("paper", improved=True, samples=3)
    assert np.isfinite(run.pose).all()
    cold.compile_apart()
    for function, kinds in cold._APART:
        assert tuple(kinds) in function.signatures
        assert all(isinstance(one, type(two)) for one, two in zip(function.signatures[0], kinds, strict=True))
        assert len(function.signatures) == 1
