"""How this room compiles: cached on disk, division by zero gives infinity, fused multiply-add allowed."""

from __future__ import annotations

from numba import njit

#: The decorator of every compiled function here.
fast = njit(cache=True, error_model="numpy", fastmath={"contract", "nsz", "arcp"})
#: The same for entry points that run in several threads at once.
fast_unlocked = njit(cache=True, error_model="numpy", fastmath={"contract", "nsz", "arcp"}, nogil=True)
