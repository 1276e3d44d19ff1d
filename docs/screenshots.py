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


#: A run of a monitor's log, and a campaign of two floors.
LOG = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,gyro_rad_s\n" + "".join(
    f"{0.01 * k:.2f},{k / 50:.2f},0,{-k / 50:.2f},{0.4 if k > 150 else 0.0}\n" for k in range(300)
)
CAMPAIGN = """schema = 1
name = "two floors"
[[data_set]]
path = "gray"
[[data_set]]
path = "table"
"""
#: What the logs of the two floors are, and how long a diagnosis may search [s].
EXCERPT, BUDGET = Path(__file__).resolve().parents[1] / "tests" / "data" / "robotino_excerpt", "15"


def commands(folder: Path) -> Iterator[list[str]]:
    """A command line for each report: bounds, sweep, plan, check, simulate, stop, monitor, design, diagnosis,
    next run; and for each picture of a command without one."""
    floor = ["--surface", "floor"]

    def page(name: str) -> list[str]:
        return ["--report", str(folder / f"{name}.html")]

    plan, pulls = str(folder / "plan.csv"), str(EXCERPT.parent / "rig" / "b-natural-loads" / "pulls.csv")
    rig = str(EXCERPT.parent / "rig" / "b-natural-loads" / "robot.toml")
    yield ["bounds", "mecanum4", *floor, *page("bounds")]
    yield ["sweep", "ohio-kiwi", "--surface", "paper", *page("sweep")]
    yield ["sweep", rig, *floor, "--measured", pulls, *page("pulls")]
    yield ["plan", "mecanum4", str(folder / "way.csv"), *floor, "--out", plan, *page("plan")]
    yield ["check", "mecanum4", plan, *floor, *page("check")]
    yield ["check", "mecanum4", plan, *floor, "--margin", "0.3", *page("slips")]
    yield ["simulate", "mecanum4", str(folder / "speeds.csv"), *floor, *page("simulate")]
    yield ["stop", "mecanum4", *floor, "--speed", "0.5", *page("stop")]
    yield ["monitor", "ohio-kiwi", str(folder / "log.csv"), "--surface", "paper", *page("monitor")]
    for name, angle in (("front_angle_deg", "30:60:10"), ("rear_angle_deg", "30:60:10")):
        yield ["design", "omni4", *floor, "--vary", f"{name}={angle}", *page(f"design-{name[:-10]}")]
    both = ["--vary", "front_angle_deg=30:60:10", "--vary", "rear_angle_deg=30:60:10"]
    yield ["design", "omni4", *floor, *both, *page("design")]
    yield ["design", "mecanum4", "omni4", "robotino", *floor, *page("ideas")]
    for name in ("gray", "table"):
        runs = map(str, sorted((EXCERPT / f"{name}_0.1").glob("*.csv")))
        yield ["import", "robotino", *runs, "--surface", name, "--out", str(folder / name)]
    end = ["--budget", BUDGET]
    yield ["diagnose", str(folder / "gray"), "--out", str(folder / "diagnosis"), *end]
    yield ["diagnose", str(folder / "campaign.toml"), "--out", str(folder / "campaign"), *end]
    yield ["next-run", str(folder / "gray"), "--space", "3x2", "--runs", "2", *page("next-run"), *end]
    yield ["diagnose", str(folder / "pulled"), "--out", str(folder / "diagnosis-of-pulls"), *end]
    yield ["polytope", "mecanum4", *floor, "--plot", str(folder / "polytope.svg")]
    yield ["reproduce", "--out", str(folder / "paper")]


def reports(folder: Path) -> list[tuple[str, Path]]:
    """Name and file of a report of each command that writes one, and of the pictures of the others."""
    texts = {"way.csv": WAY, "speeds.csv": SPEEDS, "log.csv": LOG, "campaign.toml": CAMPAIGN}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    pulled = folder / "pulled"
    shutil.copytree(EXCERPT.parent / "rig" / "a-null", pulled, dirs_exist_ok=True)
    shutil.copytree(EXCERPT.parent / "rig" / "b-natural-loads", pulled, dirs_exist_ok=True)
    shutil.rmtree(pulled / "trials", ignore_errors=True)
    for words in commands(folder):
        if words[0] == "import":
            shutil.rmtree(words[-1], ignore_errors=True)
        with contextlib.redirect_stdout(io.StringIO()):
            if status(words) != 0:
                raise SystemExit(f"failed: slipmargin {' '.join(words)}")
    drawn = [*folder.glob("*.svg"), *(folder / "paper").glob("*.png"), *(folder / "paper").glob("*.svg")]
    for file in drawn:  # a drawing that is opened by itself is no page: the browser waits for its fonts
        shown = f'<img src="{file.as_uri()}" style="max-width: 100%">'
        (folder / f"picture-{file.stem}.html").write_text(f"<!doctype html>\n{shown}\n")
    pages = [(file.stem, file) for file in sorted(folder.glob("*.html"))]
    return pages + [(file.parent.name, file) for file in sorted(folder.glob("*/report.html"))]


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
    folder: Path = asked.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        raise SystemExit("no browser: apt-get install chromium")
    pages = [(name, file.resolve().as_uri()) for name, file in reports(folder)]
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
