"""The reference page of the robot file, ``docs/robot-file.md``, from the keys themselves."""

from __future__ import annotations

from slipmargin.robot.fields import Key, Kind, keys
from slipmargin.robot.sections import SECTIONS, Section

_HEAD = """# Robot file

A robot file is TOML. Every value is in SI units and a key's name ends in its unit; keys that end in
`_deg` are in degrees. Angles are counter-clockwise. Which body
axis is the front, and which way a positive wheel speed drives, says `convention`; every number, column,
and picture of a command is in the convention of its robot file, so nothing is converted by hand.  Files for
other tools and simulators have those tools' axes: x forward, y left.
Masses, centre of mass, load fractions and friction coefficients may be uncertain: `"0.26 ± 0.02"`
(normal, one standard deviation) or the interval `[0.24, 0.28]` (uniform), as marked below. `bounds`,
`sweep` and `plan` draw from the spreads and print the chance of slip; `design` of several robots counts
those of friction; every other command uses the middle and says so.
A key that is not marked refuses a spread. Published coefficients can be used by name (`library`, see
`slipmargin surfaces list`); [measure yours in ten minutes](how-to/measure-friction.md).
A key that is not named here is an error. A key that can have no effect beside the others is an error too or,
where it may yet be meant, answered with a warning. Ranges
are wide: they are there to catch slips of unit and sign. The file starts with `schema = 1`.
`slipmargin robots show ohio-kiwi` prints a whole file.

The column *`--vary`* names the quantities by which `slipmargin design` reaches a key: numbers take a range
(`mass_kg=2:4:0.5`) or a list (`mass_kg=2,3`), words a list (`grip=box,ellipse`). A number of a single wheel
or effect is reached by its place: `wheel[2].radius_m`, `wheel[rear].radius_m`, `effect[1].rigid_fraction`.

(This page is made from the fields of `slipmargin.robot` by `slipmargin.report.robot_file_page`; a test
compares the two.)"""

_TAIL = """## `[[effect]]`

Physics that the paper's model lacks, one table for each effect: `name` and the effect's own keys, see
[effects](effects.md).

## Warnings

A file is read, but the commands print a warning, where

- the loads of `"equal"` or `"fixed"` contradict the centre of mass by more than 1 % of m g / N;
- `com_height_m` is given but the stated load model is not `"quasi-static"` (how much load a m/s² shifts);
- `roller` and `rigid` of a surface are alike, so that `rigid_fraction` and `rollers` have no effect there;
- with the grip `"disc-strip"` a transverse coefficient exceeds the drive one, which then limits both;
- an effect makes friction steep across the rollers and the grip is coupled throughout, so that only the
  steepness along the grip counts;
- every mecanum wheel drives to the side: the file's axes are those of the other `convention`;
- the grip line of a mecanum wheel passes nearer to the wheels' middle than it would with the other sign of
  `roller_angle_deg`: rollers mounted the wrong way round;
- wheel positions, wheel radius, height and radius of gyration √(inertia / mass) do not belong to one robot: a
  value in millimetres or grams (what no robot can have is refused);
- a friction coefficient is above 1.5;
- a command does not use what the file says of its own uncertainty (a spread, or the band of loads)."""


def robot_file_page() -> str:
    """The whole page as Markdown."""
    parts = [_HEAD, *(_section(section) for section in SECTIONS), _TAIL]
    return "\n\n".join(parts) + "\n"


def _section(section: Section) -> str:
    title = f"## `{section.heading}`" if section.heading else "## Top of the file"
    found = keys(section.kind, section.table)
    parts = [title, section.meaning, _table(found)]
    for key in found.values():
        if key.kind is Kind.WORD:
            pairs = zip(key.choices, key.meanings, strict=True)
            parts.append("\n".join([f"`{key.name}`:", "", *(f"- `{w}`: {said}" for w, said in pairs)]))
    tables = {key.of: key.name for key in found.values() if key.of is not None}
    for kind in tables:
        names = " and ".join(f"`{key.name}`" for key in found.values() if key.of is kind)
        parts += [f"The keys of {names}:", _table(keys(kind))]
    return "\n\n".join(parts)


def _table(found: dict[str, Key]) -> str:
    rows = [
        f"| `{k.name}` | {_value(k)} | {_default(k)} | {', '.join(f'`{v}`' for v in k.vary) or '–'} "
        f"| {_meaning(k, found)} |"
        for k in found.values()
    ]
    return "\n".join(["| key | value | default | `--vary` | meaning |", "|---|---|---|---|---|", *rows])


def _value(key: Key) -> str:
    if key.kind is Kind.WORD:
        return " or ".join(f'`"{w}"`' for w in key.choices)
    if key.kind is Kind.LIST:
        many = "list of numbers" if key.count is None else f"list of {key.count} numbers"
        spread = ', each also `"0.01 ± 0.005"` or `[0.0, 0.02]`' if key.uncertain else ""
        return f"{many}, each {key.range}{spread}"
    if key.kind in (Kind.NUMBER, Kind.WHOLE):
        spread = ', `"0.26 ± 0.02"` or `[0.24, 0.28]`' if key.uncertain else ""
        return f"{key.kind.value}, {key.range}{spread}"
    return str(key.kind.value)


def _default(key: Key) -> str:
    if key.required:
        return "required"
    if key.default is None:
        return "none"
    if key.kind is Kind.LIST:
        return f"`{[float(x) for x in key.default]}`"
    if key.kind is Kind.WORD:
        return next(f'`"{word}"`' for word in key.choices if key.from_word(word) == key.default)
    return f"`{key.default}`"


def _meaning(key: Key, beside: dict[str, Key]) -> str:
    said = f"{key.meaning} ({key.reason})" if key.reason else key.meaning
    needed = [f'`{beside[o].name} = "{word}"`' if word else f"`{beside[o].name}`" for o, word in key.needs]
    return f"{said}; only with {' and '.join(needed)}" if needed else said
