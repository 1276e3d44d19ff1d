"""The style sheet of every page: one column, light or dark by the reader's choice, quiet on paper."""

from __future__ import annotations

CSS = """
:root { --ink: #1d2126; --soft: #565d66; --line: #d5d9de; --ground: #ffffff; --card: #f4f6f8;
  --good: #00755a; --attention: #b34700; --plain: #005a94; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8eaed; --soft: #a9b1ba; --line: #3a4048;
  --ground: #16191d; --card: #20252b; --good: #4fc3a1; --attention: #f0985a; --plain: #6db8ee; } }
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
figure { margin: 1rem 0 1.4rem; }
.plot { background: #ffffff; border-radius: 6px; padding: .4rem; border: 1px solid var(--line); }
.plot svg { display: block; width: 100%; height: auto; max-height: 60rem; }
.plot svg text { font-family: system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", Arial, sans-serif
  !important; }
figcaption { color: var(--soft); font-size: .88rem; margin-top: .4rem; max-width: 46rem; }
pre { white-space: pre-wrap; overflow-wrap: anywhere;
  background: var(--card); border-radius: 6px; padding: .7rem .9rem; overflow-x: auto; font-size: .85rem;
  }
code { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; font-size:
  .92em; }
details { margin: .8rem 0; } summary { cursor: pointer; font-weight: 600; }
footer { margin-top: 2.5rem; color: var(--soft); font-size: .83rem; border-top: 1px solid var(--line);
  padding-top: .6rem; }
@media print { :root { --ink: #000; --soft: #444; --ground: #fff; --card: #f4f4f4; --line: #bbb; }
  body { max-width: none; font-size: 10.5pt; padding: 0; } figure, table, .facts { break-inside: avoid; }
  .plot { border: 0; padding: 0; } h2 { break-after: avoid; } }
"""
