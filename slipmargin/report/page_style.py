"""The style sheet of every page: one column, light or dark by the reader's choice, quiet on paper."""

from __future__ import annotations

#: A colour of the figures (plots/style.py) → the variable below that follows light, dark and paper.
FIGURE_COLOURS = {
    "#ffffff": "--ground",
    "#222222": "--ink",
    "#000000": "--ink",
    "#767676": "--soft",
    "#d9d9d9": "--line",
    "#cfcfcf": "--line",
    "#0072b2": "--blue",
    "#e69f00": "--orange",
    "#009e73": "--green",
    "#d55e00": "--red",
    "#cc79a7": "--purple",
    "#56b4e9": "--sky",
}

CSS = """
:root { --ink: #1d2126; --soft: #565d66; --line: #d5d9de; --ground: #ffffff; --card: #f4f6f8;
  --good: #00755a; --attention: #b34700; --plain: #005a94;
  --blue: #0072b2; --orange: #e69f00; --green: #009e73; --red: #d55e00; --purple: #cc79a7; --sky: #56b4e9; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8eaed; --soft: #a9b1ba; --line: #3a4048;
  --ground: #16191d; --card: #20252b; --good: #4fc3a1; --attention: #f0985a; --plain: #6db8ee;
  --blue: #58b4f0; --orange: #f0b429; --green: #3fc79d; --red: #ff8a4c; --purple: #e39cc4; --sky: #7cc7f2; } }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 60rem; padding: 1.5rem 1.1rem 3rem; background: var(--ground); color:
  var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.45rem; line-height: 1.25; margin: 0 0 .8rem; }
h2 { font-size: 1.15rem; margin: 2.4rem 0 .6rem; padding-top: .7rem; border-top: 1px solid var(--line); }
p, ul, ol { margin: .6rem 0; max-width: 46rem; }
li { margin: .25rem 0; }
.lead { font-size: 1.12rem; line-height: 1.45; border-left: 5px solid var(--plain); padding: .35rem 0 .35rem
  .9rem;
  margin: 0 0 1rem; }
.lead.good { border-color: var(--good); } .lead.attention { border-color: var(--attention); }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(12.5rem, 1fr)); gap: .7rem; margin:
  1rem 0; }
.facts div { background: var(--card); border-radius: 6px; padding: .6rem .8rem; }
.facts dt { font-size: .83rem; color: var(--soft); }
.facts dd { margin: 0; font-size: 1.22rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.facts dd.note { font-size: .83rem; font-weight: 400; color: var(--soft); }
.wide, .plot { overflow-x: auto; }
table { border-collapse: collapse; margin: .7rem 0; font-size: .93rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); font-size: .88rem; padding-bottom: .3rem; }
th, td { padding: .32rem .9rem .32rem 0; border-bottom: 1px solid var(--line); text-align: left;
  vertical-align: top; }
thead th { font-weight: 600; border-bottom: 2px solid var(--line); }
tbody th { font-weight: 500; }
table.numbers td, table.numbers thead th:not(:first-child) { text-align: right; padding-left: .9rem; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(19rem, 100%), 1fr)); gap: 0 1rem;
  align-items: start; }
figure { margin: 1rem 0 1.4rem; }
.plot { background: var(--ground); border-radius: 6px; padding: .4rem; border: 1px solid var(--line); }
.plot svg { display: block; width: 100%; height: auto; max-height: 60rem; }
.plot svg text { font-family: system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", Arial, sans-serif
  !important; fill: var(--ink); }
figcaption { color: var(--soft); font-size: .88rem; margin-top: .4rem; max-width: 46rem; }
pre { white-space: pre-wrap; overflow-wrap: anywhere;
  background: var(--card); border-radius: 6px; padding: .7rem .9rem; overflow-x: auto; font-size: .85rem;
  }
code { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; font-size:
  .92em; }
.whole { white-space: nowrap; }
details { margin: .8rem 0; } summary { cursor: pointer; font-weight: 600; }
footer { margin-top: 2.5rem; color: var(--soft); font-size: .83rem; border-top: 1px solid var(--line);
  padding-top: .6rem; }
@media (max-width: 34rem) { table { font-size: .72rem; } .plot { padding: .2rem; }
  th, td { padding-right: .3rem; } .long { overflow-wrap: anywhere; }
  table.numbers td, table.numbers thead th:not(:first-child) { padding-left: .1rem; } }
@media print { :root { --ink: #000; --soft: #444; --ground: #fff; --card: #f4f4f4; --line: #bbb;
  --good: #00755a; --attention: #b34700; --plain: #005a94; --blue: #0072b2; --orange: #e69f00;
  --green: #009e73; --red: #d55e00; --purple: #cc79a7; --sky: #56b4e9; }
  @page { size: A4; margin: 16mm 14mm; } html { color-scheme: light; }
  details::details-content { content-visibility: visible; display: block; height: auto; }
  .wide, .plot { overflow: visible; } .plot svg { min-width: 0 !important; max-width: 100% !important; }
  table { font-size: .82rem; } th, td { padding-right: .5rem; }
  body { max-width: none; font-size: 10.5pt; padding: 0; } figure, table, .facts { break-inside: avoid; }
  .plot { border: 0; padding: 0; } h2 { break-after: avoid; } }
"""
