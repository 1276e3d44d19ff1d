"""Pages of the site that are made from the program while it is built: help texts and the Python API."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

sys.path.insert(0, str(Path(__file__).resolve().parent))
from terms import anchored, linked

os.environ["COLUMNS"] = "100"
os.environ["TERM"] = "dumb"


def help_text(words: list[str]) -> str:
    """What a command prints for ``--help``, without colours and frames' trailing spaces."""
    from slipmargin_cli.main import status

    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        status([*words, "--help"])
    plain = re.sub(r"\x1b\[[0-9;]*m", "", printed.getvalue())
    return "\n".join(line.rstrip() for line in plain.splitlines()).strip()


def help_page() -> str:
    """The ``--help`` of every command and subcommand, as the terminal shows it."""
    import typer
    from slipmargin_cli.main import COMMANDS, application

    parts = ["# Options of every command\n", "What `slipmargin COMMAND --help` prints.\n"]
    for name in COMMANDS:
        group = typer.main.get_command(application([name]))
        command = getattr(group, "commands", {}).get(name, group)
        inner = [[name, sub] for sub in getattr(command, "commands", {})]
        for words in ([name], *inner):
            parts.append(f"{'#' * (1 + len(words))} {' '.join(words)}\n\n```text\n{help_text(words)}\n```\n")
    return "\n".join(parts)


def python_page() -> str:
    """The front door: every public function with its docstring."""
    import slipmargin

    names = [name for name in dir(slipmargin) if not name.startswith("_")]
    modules = slipmargin._CONTENTS
    blocks = [f"::: {modules[name]}.{name}\n" for name in names]
    return "# Python\n\n`import slipmargin as sm`: every command is a function.\n\n" + "\n".join(blocks)


def on_files(files: Files, config: MkDocsConfig, **_: Any) -> Files:
    """Add the generated pages."""
    for path, text in {"reference/help.md": help_page(), "reference/python.md": python_page()}.items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Link the glossary's terms where a page first uses them."""
    source = page.file.src_uri
    if source == "glossary.md":
        return anchored(markdown)
    if source.startswith("notebooks/") or source in {"reference/help.md", "reference/python.md"}:
        return markdown
    return linked(markdown, "../" * source.count("/"))


#: What docstrings write before a name for other tools: a reader of the page needs the name only.
_ROLE = re.compile(r":(?:func|meth|mod|class|data|attr):(<code[^>]*>)(?:~?slipmargin(?:\.\w+)*\.(?=\w)|~)?")


#: Characters from which a table's cell is a sentence, which needs a column of some width to be read.
_SENTENCE = 40
_CELL = re.compile(r"<td>(.*?)</td>", re.DOTALL)


def on_page_content(html: str, page: Page, **_: Any) -> str:
    """Show a docstring's cross-reference as the name it refers to; call long cells of tables long."""
    if page.file.src_uri == "reference/python.md":
        html = _ROLE.sub(r"\1", html)
    return _CELL.sub(_of_width, html)


def _of_width(cell: re.Match[str]) -> str:
    long = len(re.sub(r"<[^>]*>", "", cell[1])) >= _SENTENCE
    return f'<td class="long">{cell[1]}</td>' if long else cell[0]
