"""How drawn tests are drawn: the same examples in continuous integration, new ones at every desk.

A defect that only one draw in a thousand shows is found at a desk and kept as a test of its own; a
submission must not fail or pass by luck.
"""

from __future__ import annotations

import os

from hypothesis import settings

settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")
