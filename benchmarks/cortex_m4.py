"""Instructions of one call of the C header on a Cortex-M4, counted by QEMU.

It needs ``arm-none-eabi-gcc``, newlib and ``qemu-system-arm`` (Debian: gcc-arm-none-eabi,
libnewlib-arm-none-eabi, qemu-system-arm).  QEMU's -icount lets its clock run one nanosecond an
instruction; the machine mps2-an386 counts that clock by SysTick at 25 MHz, so 40 instructions a tick.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np

import slipmargin as sm

#: How often a state is called between two readings of the counter; instructions a tick.
REPEAT, PER_TICK = 40, 40
QEMU = ("qemu-system-arm", "-M", "mps2-an386", "-nographic", "-icount", "shift=0")
QEMU += ("-semihosting-config", "enable=on,target=native", "-kernel")
_START = """
#include <stdint.h>
#include "limit.h"
extern int main(void);
extern uint32_t stack_top;
void reset(void) {
  *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* the floating-point unit */
  main();
  for (;;) {}
}
__attribute__((section(".vectors"), used)) static const void *vectors[2] = {&stack_top, (const void *)reset};
static void host(int operation, const void *argument) {
  register int r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}
static void tell(uint32_t value) {
  char text[12];
  int at = 11;
  text[at] = 0;
  text[--at] = '\\n';
  do { text[--at] = (char)('0' + value % 10); value /= 10; } while (value);
  host(4, text + at);
}
static uint32_t ticks(void) { return 0xFFFFFFu - *(volatile uint32_t *)0xE000E018u; }
static const float states[COUNT][6] = {STATES};
int main(void) {
  int k, i;
  uint32_t base;
  *(volatile uint32_t *)0xE000E014u = 0xFFFFFFu;
  for (k = 0; k < COUNT; ++k) {
    volatile float keep = 0;
    const float *s = states[k];
    const sm_twist now = {s[0], s[1], s[2]}, to = {s[3], s[4], s[5]};
    const sm_acceleration a = {s[3], s[4], s[5]};
    sm_twist next;
    sm_acceleration b;
    int wheel;
    *(volatile uint32_t *)0xE000E010u = 0;
    *(volatile uint32_t *)0xE000E018u = 0;
    *(volatile uint32_t *)0xE000E010u = 5;
    while (*(volatile uint32_t *)0xE000E018u == 0) {}
    base = ticks();
    for (i = 0; i < REPEAT; ++i) { sm_limit_twist(now, to, 0.01f, 0.0f, &next); keep += next.vx_m_s; }
    tell(ticks() - base);
    base = ticks();
    for (i = 0; i < REPEAT; ++i) { sm_limit_acceleration(now, 0.0f, a, &b); keep += b.ax_m_s2; }
    tell(ticks() - base);
    base = ticks();
    for (i = 0; i < REPEAT; ++i) keep += sm_margin(now, a, 0.0f, &wheel);
    tell(ticks() - base);
  }
  host(0x18, (void *)0x20026);
  return 0;
}
"""
_LINK = """
ENTRY(reset)
MEMORY { ram (rwx) : ORIGIN = 0x0, LENGTH = 4M }
SECTIONS {
  .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) } > ram
  .data : { *(.data*) } > ram
  .bss : { *(.bss*) *(COMMON) } > ram
  stack_top = ORIGIN(ram) + LENGTH(ram);
}
"""


def missing() -> list[str]:
    """The programs that are not on this machine."""
    return [name for name in ("arm-none-eabi-gcc", "qemu-system-arm") if not shutil.which(name)]


def instructions(limiter: sm.Limiter, states: np.ndarray, folder: Path) -> dict[str, dict[str, float]]:
    """Mean and largest number of instructions of each function over states (K, 6): twist, what is wanted."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "limit.h").write_text(limiter.c_header(), encoding="utf-8")
    cells = ",".join("{" + ",".join(f"{v:.6e}f" for v in row) + "}" for row in states)
    code = _START.replace("COUNT", str(len(states))).replace("REPEAT", str(REPEAT)).replace("STATES", cells)
    (folder / "main.c").write_text(code, encoding="utf-8")
    (folder / "link.ld").write_text(_LINK, encoding="utf-8")
    flags = ["-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-O2", "-std=gnu99"]
    flags += ["-fno-math-errno", "-nostartfiles", "-T", str(folder / "link.ld")]
    image = folder / "limit.elf"
    subprocess.run(
        ["arm-none-eabi-gcc", *flags, str(folder / "main.c"), "-o", str(image), "-lm", "-lc", "-lgcc"],
        check=True,
        capture_output=True,
    )
    done = subprocess.run(
        [*QEMU, str(image)],
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    told = np.array([int(word) for word in (done.stdout + done.stderr).split() if word.isdigit()])
    count = told.reshape(-1, 3) * PER_TICK / REPEAT
    assert len(count) == len(states), done.stdout + done.stderr
    names = ("sm_limit_twist", "sm_limit_acceleration", "sm_margin")
    size = subprocess.run(["arm-none-eabi-size", str(image)], check=True, capture_output=True, text=True)
    out = {n: {"mean": float(c.mean()), "most": float(c.max())} for n, c in zip(names, count.T, strict=True)}
    out["code and tables [bytes]"] = {"all": float(size.stdout.splitlines()[1].split()[0])}
    return out
