"""A server for one reader at this machine: 127.0.0.1 only, no other host or origin, nothing written.

The standard library's server is enough: one page, five addresses, one reader.  Frameworks for such pages
(Panel, Dash, NiceGUI, Streamlit) bring 60 to 300 MB and their own scripts; this page is 30 kB of its own.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from time import thread_time
from typing import Any, final
from urllib.parse import parse_qsl, urlsplit

from slipmargin.errors import InputError, SlipmarginError
from slipmargin.io.assets import asset
from slipmargin.io.json_text import json_text
from slipmargin.io.writes import write_bytes
from slipmargin.report.not_given import with_reasons

#: The only address that is listened on.
HOST = "127.0.0.1"
#: The largest file that may be dropped on the page [bytes].
LARGEST = 5_000_000
_PAGES = {
    "/": ("page.html", "text/html"),
    "/page.js": ("page.js", "text/javascript"),
    "/page.css": ("page.css", "text/css"),
}
#: What the page may load: itself.  A report that is shown brings its own styles and may run no script.
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

#: (query, file dropped or None) → the answer as plain data.
Answer = Callable[[Mapping[str, str], Path | None], Any]


@final
class Server(ThreadingHTTPServer):
    """Serves the page and its answers; ``address`` is what the browser opens."""

    daemon_threads = True

    def __init__(self, answers: Mapping[str, Answer], port: int = 0) -> None:
        super().__init__((HOST, port), _Handler)
        self.answers = answers
        self.hosts = {f"{name}:{self.server_port}" for name in (HOST, "localhost")}

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A reader that went away before the answer is no fault."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)

    @property
    def address(self) -> str:
        """The page's address."""
        return f"http://{HOST}:{self.server_port}/"


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "slipmargin", ""

    def do_GET(self) -> None:
        """A page's file, or an answer."""
        if not self._refused():
            self._answer(None)

    def do_POST(self) -> None:
        """An answer about a file that was dropped on the page."""
        if self._refused():
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdigit() or int(length) > LARGEST:
            self.close_connection = True
            return self._send(413, {"error": f"the file is larger than {LARGEST // 1_000_000} MB"})
        content = self.rfile.read(int(length))
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "dropped.csv"
            write_bytes(file, content)
            self._answer(file)

    def _refused(self) -> bool:
        """Whether the request comes from, or is meant for, another host; it is then answered."""
        origin = self.headers.get("Origin")
        ours = self.headers.get("Host") in self.server.hosts
        if ours and (origin is None or origin.removeprefix("http://") in self.server.hosts):
            return False
        self.close_connection = True
        self._send(403, {"error": "this page answers its own address only"})
        return True

    def _answer(self, file: Path | None) -> None:
        asked = urlsplit(self.path)
        if asked.path in _PAGES and file is None:
            name, kind = _PAGES[asked.path]
            return self._write(200, asset(name).encode(), kind)
        answer = self.server.answers.get(asked.path.removeprefix("/api/"))
        if answer is None:
            return self._send(404, {"error": "there is no such page"})
        query, start = dict(parse_qsl(asked.query)), thread_time()
        try:
            found = answer(query, file)
        except InputError as fault:
            said = fault if file is None or fault.source != str(file) else fault.in_file("the file")
            return self._send(400, {"error": str(said)})
        except SlipmarginError as fault:
            return self._send(400, {"error": str(fault)})
        except Exception as defect:
            return self._send(500, {"error": f"internal error: {type(defect).__name__}: {defect}"})
        self._send(
            200, with_reasons(found), {"Server-Timing": f"cpu;dur={1e3 * (thread_time() - start):.2f}"}
        )

    def _send(self, status: int, data: Any, headers: Mapping[str, str] | None = None) -> None:
        self._write(status, json_text(data, indent=None).encode(), "application/json", headers or {})

    def _write(self, status: int, body: bytes, kind: str, headers: Mapping[str, str] | None = None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is logged: the package prints nothing."""
