"""The generated C header as a library: compiled, loaded and called on arrays of states."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np

import slipmargin as sm

#: How the header must compile, and the language.
STRICT = ("-Wall", "-Wextra", "-Werror", "-pedantic", "-O3")
COMPILERS = {"gcc": "c99", "clang": "c99", "g++": "c++17", "clang++": "c++17"}
_CALLS = """
#include "limit.h"
#ifdef __cplusplus
extern "C" {
#endif
typedef sm_real R;
int twists(long n, const R *v, const R *w, const R *dt, const R *h, R *out, int *code);
int accelerations(long n, const R *v, const R *w, const R *h, R *out, int *code);
int margins(long n, const R *v, const R *a, const R *h, R *out, int *wheel);
int twists(long n, const R *v, const R *w, const R *dt, const R *h, R *out, int *code) {
  long k;
  for (k = 0; k < n; ++k) {
    sm_twist now, to, next;
    now.vx_m_s = v[3 * k]; now.vy_m_s = v[3 * k + 1]; now.wz_rad_s = v[3 * k + 2];
    to.vx_m_s = w[3 * k]; to.vy_m_s = w[3 * k + 1]; to.wz_rad_s = w[3 * k + 2];
    code[k] = (int)sm_limit_twist(now, to, dt[k], h[k], &next);
    out[3 * k] = next.vx_m_s; out[3 * k + 1] = next.vy_m_s; out[3 * k + 2] = next.wz_rad_s;
  }
  return SM_WHEELS;
}
int accelerations(long n, const R *v, const R *w, const R *h, R *out, int *code) {
  long k;
  for (k = 0; k < n; ++k) {
    sm_twist now;
    sm_acceleration to, next;
    now.vx_m_s = v[3 * k]; now.vy_m_s = v[3 * k + 1]; now.wz_rad_s = v[3 * k + 2];
    to.ax_m_s2 = w[3 * k]; to.ay_m_s2 = w[3 * k + 1]; to.alpha_rad_s2 = w[3 * k + 2];
    code[k] = (int)sm_limit_acceleration(now, h[k], to, &next);
    out[3 * k] = next.ax_m_s2; out[3 * k + 1] = next.ay_m_s2; out[3 * k + 2] = next.alpha_rad_s2;
  }
  return SM_WHEELS;
}
int margins(long n, const R *v, const R *a, const R *h, R *out, int *wheel) {
  long k;
  for (k = 0; k < n; ++k) {
    sm_twist now;
    sm_acceleration to;
    now.vx_m_s = v[3 * k]; now.vy_m_s = v[3 * k + 1]; now.wz_rad_s = v[3 * k + 2];
    to.ax_m_s2 = a[3 * k]; to.ay_m_s2 = a[3 * k + 1]; to.alpha_rad_s2 = a[3 * k + 2];
    out[k] = sm_margin(now, to, h[k], wheel + k);
  }
  return SM_WHEELS;
}
#ifdef __cplusplus
}
#endif
"""


def compilers() -> list[str]:
    """The compilers that this machine has."""
    return [name for name in COMPILERS if shutil.which(name)]


class CompiledLimiter:
    """A header compiled by one compiler; raises RuntimeError with its messages where that fails."""

    def __init__(self, limiter: sm.Limiter, folder: Path, compiler: str, *, double: bool) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "limit.h").write_text(limiter.c_header(), encoding="utf-8")
        source = folder / ("calls.cpp" if "++" in compiler else "calls.c")
        source.write_text(_CALLS, encoding="utf-8")
        library = folder / f"limit-{compiler}-{'double' if double else 'float'}.so"
        flags = [
            "-shared",
            "-fPIC",
            *STRICT,
            f"-std={COMPILERS[compiler]}",
            *(["-DSM_DOUBLE"] if double else []),
        ]
        done = subprocess.run(
            [compiler, *flags, str(source), "-o", str(library), "-lm"], capture_output=True, text=True
        )
        if done.returncode:
            raise RuntimeError(done.stderr)
        self.dtype = np.float64 if double else np.float32
        self._library = ctypes.CDLL(str(library))

    def prepared(
        self, name: str, inputs: list[np.ndarray], columns: int
    ) -> tuple[Callable[[], None], np.ndarray, np.ndarray]:
        """A function that runs the C loop over inputs of its type, its answers and its codes."""
        given = [np.ascontiguousarray(values, dtype=self.dtype) for values in inputs]
        count = len(given[0])
        out, code = np.empty((count, columns), dtype=self.dtype), np.empty(count, dtype=np.int32)
        arrays = (*given, out, code)
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in arrays]
        loop = getattr(self._library, name)

        def run(arrays: tuple[np.ndarray, ...] = arrays) -> None:
            loop(ctypes.c_long(count), *pointers)

        return run, out, code

    def _call(self, name: str, inputs: list[np.ndarray], columns: int) -> tuple[np.ndarray, np.ndarray]:
        run, out, code = self.prepared(name, inputs, columns)
        run()
        return out.astype(float), code

    def limit_twist(self, now, wanted, dt_s, heading_rad):  # type: ignore[no-untyped-def]
        """As :meth:`slipmargin.Limiter.limit_twist`."""
        return self._call("twists", [now, wanted, dt_s, heading_rad], 3)

    def limit_acceleration(self, now, wanted, heading_rad):  # type: ignore[no-untyped-def]
        """As :meth:`slipmargin.Limiter.limit_acceleration`."""
        return self._call("accelerations", [now, wanted, heading_rad], 3)

    def margin(self, now, acceleration, heading_rad):  # type: ignore[no-untyped-def]
        """As :meth:`slipmargin.Limiter.margin`, the wheel as a number."""
        share, wheel = self._call("margins", [now, acceleration, heading_rad], 1)
        return share[:, 0], wheel
