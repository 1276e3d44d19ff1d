"""Photograph every report, the local page and the site's pages into one contact sheet.

``python docs/screenshots.py FOLDER [--site]``: each page at 1280 and 400 px, light and dark, and sheets
``contact-1.png`` and so on with all of them.  What can be told without eyes is printed: a page wider than its
window, text or a picture that is cut, a console message, a request to another host.
Needs Chromium (``apt-get install chromium``) and Playwright.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

from PIL import Image, ImageDraw
from playwright.sync_api import Browser, sync_playwright
from slipmargin_cli.main import status

import slipmargin as sm

WIDTHS, SCHEMES = (1280, 400), ("light", "dark")
#: Height of a picture on a sheet [px], the most of a page that is shown [widths], pages a sheet.
THUMB, TALLEST, A_SHEET = 900, 4, 6
#: Time in which a page's scripts end [ms], and that a busy machine has to load it.
SETTLE_MS, PATIENCE_MS = 400, 120_000
WAY = "x_m,y_m,phi_rad\n0,0,0\n1,0,0\n1,1,0\n"
SPEEDS = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s\n0,10,10,10,10\n1,0,0,0,0\n1.5,0,0,0,0\n"


def reports(folder: Path) -> list[Path]:
    """A report of each command that writes one."""
    (folder / "way.csv").write_text(WAY, encoding="utf-8")
    (folder / "speeds.csv").write_text(SPEEDS, encoding="utf-8")
    at = {
        name: str(folder / f"{name}.html")
        for name in ("bounds", "sweep", "plan", "check", "slips", "simulate")
    }
    plan, robot = str(folder / "plan.csv"), ("mecanum4",)
    angles = ("--vary", "front_angle_deg=30:60:10", "--vary", "rear_angle_deg=30:60:10")
    for words in (
        ("bounds", *robot, "--surface", "floor", "--report", at["bounds"]),
        ("sweep", "ohio-kiwi", "--surface", "paper", "--report", at["sweep"]),
        (
            "plan",
            *robot,
            str(folder / "way.csv"),
            "--surface",
            "floor",
            "--out",
            plan,
            "--report",
            at["plan"],
        ),
        ("check", *robot, plan, "--surface", "floor", "--report", at["check"]),
        ("check", *robot, plan, "--surface", "floor", "--margin", "0.3", "--report", at["slips"]),
        ("simulate", *robot, str(folder / "speeds.csv"), "--surface", "floor", "--report", at["simulate"]),
        ("design", "omni4", "--surface", "floor", *angles, "--report", str(folder / "design.html")),
        (
            "design",
            "mecanum4",
            "omni4",
            "robotino",
            "--surface",
            "floor",
            "--report",
            str(folder / "ideas.html"),
        ),
    ):
        with contextlib.redirect_stdout(io.StringIO()):
            if status(list(words)) != 0:
                raise SystemExit(f"failed: slipmargin {' '.join(words)}")
    return sorted(folder.glob("*.html"))


@contextlib.contextmanager
def local_page() -> Iterator[str]:
    """The page of ``slipmargin explore``, and its address."""
    server = sm.explore("mecanum4", "floor").serve()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server.address
    finally:
        server.shutdown()
        server.server_close()


#: What is cut at the right: an element that hangs out of the window, where nothing scrolls it into view.
CUT = """
() => [...document.querySelectorAll('table, pre, img, svg, figure, h1, h2, h3, p, li, td')].filter(e => {
  const r = e.getBoundingClientRect();
  if (r.width === 0 || r.right <= innerWidth + 1) return false;
  for (let up = e.parentElement; up; up = up.parentElement) {
    const flow = getComputedStyle(up).overflowX;
    if (flow === 'auto' || flow === 'scroll' || up.closest('[data-md-state], nav, .md-sidebar')) return false;
  }
  return true;
}).map(e => e.tagName.toLowerCase() + ' “' + e.textContent.trim().slice(0, 40) + '”').slice(0, 3)
"""


def photograph(browser: Browser, address: str, name: str, folder: Path) -> tuple[list[Path], set[str]]:
    """A page at every width and in every scheme, and what is wrong with it."""
    made: list[Path] = []
    wrong: set[str] = set()

    def heard(kind: str, text: str) -> None:
        if kind in {"error", "warning"}:
            wrong.add(f"console: {text}")

    def asked(at: str) -> None:
        if urlsplit(at).netloc not in {urlsplit(address).netloc, ""}:
            wrong.add(f"asks {at}")

    for scheme in SCHEMES:
        page = browser.new_page(color_scheme=scheme)  # nothing remembered of the other scheme
        page.set_default_timeout(PATIENCE_MS)
        page.on("console", lambda message: heard(message.type, message.text))
        page.on("pageerror", lambda fault: heard("error", str(fault)))
        page.on("request", lambda request: asked(request.url))
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            page.goto(address)
            page.wait_for_load_state("networkidle")
            page.wait_for_timeout(SETTLE_MS)
            wide = page.evaluate("document.documentElement.scrollWidth")
            if wide > width:
                wrong.add(f"{wide} px wide in a window of {width}")
            wrong |= {f"cut at {width}: {what}" for what in page.evaluate(CUT)}
            file = folder / f"{name}-{width}-{scheme}.png"
            page.screenshot(path=file, full_page=True)
            made.append(file)
        page.close()
    return sorted(made, key=lambda file: file.name.split("-")[-2:]), wrong


def contact_sheet(groups: dict[str, list[Path]], file: Path) -> None:
    """All pictures, a row a page."""
    rows = []
    for name, files in groups.items():
        pictures = []
        for one in files:
            picture = Image.open(one).convert("RGB")
            picture = picture.crop((0, 0, picture.width, min(picture.height, TALLEST * picture.width)))
            scale = THUMB / max(picture.height, 0.6 * picture.width)
            pictures.append(picture.resize((int(picture.width * scale), int(picture.height * scale))))
        rows.append((name, pictures))
    wide = max(sum(p.width + 12 for p in pictures) for _, pictures in rows)
    sheet = Image.new("RGB", (wide, len(rows) * (THUMB + 32)), "#888888")
    draw = ImageDraw.Draw(sheet)
    for k, (name, pictures) in enumerate(rows):
        x, y = 0, k * (THUMB + 32)
        draw.text((6, y + 8), name, fill="white")
        for picture in pictures:
            sheet.paste(picture, (x, y + 28))
            x += picture.width + 12
    sheet.save(file)


def main() -> None:
    """Photograph and lay out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--site", action="store_true", help="also every page of site/ (make docs)")
    asked = parser.parse_args()
    folder: Path = asked.folder
    folder.mkdir(parents=True, exist_ok=True)
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        raise SystemExit("no browser: apt-get install chromium")
    pages = [(file.stem, file.resolve().as_uri()) for file in reports(folder)]
    site = Path(__file__).resolve().parents[1] / "site"
    if asked.site:
        found = sorted(p for p in site.rglob("*.html") if p.name != "404.html")
        pages += [("-".join(p.relative_to(site).with_suffix("").parts), p.as_uri()) for p in found]
    groups: dict[str, list[Path]] = {}
    faults = 0
    with sync_playwright() as play, local_page() as address:
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for name, at in [*pages, ("explore", address)]:
            groups[name], wrong = photograph(browser, at, name, folder)
            faults += len(wrong)
            for one in sorted(wrong):
                print(f"{name}: {one}")
        browser.close()
    names = list(groups)
    for k in range(0, len(names), A_SHEET):
        some = {name: groups[name] for name in names[k : k + A_SHEET]}
        contact_sheet(some, folder / f"contact-{k // A_SHEET + 1}.png")
    print(f"{sum(map(len, groups.values()))} pictures of {len(groups)} pages in {folder}, {faults} faults")


if __name__ == "__main__":
    main()
