"""The local page under requests that a case holds: its answers become files, which are judged."""

from __future__ import annotations

import os
import re
import socket
import sys
import threading
from pathlib import Path

from slipmargin.live.server import HOST, Server

#: An answer takes no longer [s]; on a busy machine that says little: who forks sees what hangs.
WAIT_S = 3600.0
#: What the page answers, or the standard library where a request is none: never 500, a defect.
KNOWN = (b"200", b"400", b"403", b"404", b"408", b"411", b"413", b"414", b"431", b"501", b"505")


def answer_requests(folder: Path) -> None:
    """From here on a server answers the requests in ``folder`` and then ends."""

    def serve(server: Server, poll_interval: float = 0.5) -> None:
        for file in sorted(folder.glob("request-*")):
            client = threading.Thread(target=_ask, args=(server.server_port, file), daemon=True)
            client.start()
            server.handle_request()
            client.join(WAIT_S)
            if client.is_alive():
                print(f"Traceback: no answer to {file.name} within {WAIT_S:g} s", file=sys.stderr)

    Server.serve_forever = serve  # type: ignore[method-assign]


def _ask(port: int, file: Path) -> None:
    data = file.read_bytes().replace(b"HOST", f"{HOST}:{port}".encode())
    with socket.create_connection((HOST, port)) as line:
        line.settimeout(WAIT_S)
        line.sendall(data)
        line.shutdown(socket.SHUT_WR)
        found = b""
        try:
            while part := line.recv(1 << 16):
                found += part
        except ConnectionError:
            pass
    head, _, body = found.partition(b"\r\n\r\n")
    status = head.split(b" ")[1:2] if head.startswith(b"HTTP/") else []  # an old client's answer has no head
    if status and status[0] not in KNOWN:
        os.write(2, b"Traceback: status " + status[0] + b"\n")
    length = re.search(rb"(?mi)^content-length: *(\d+)", head)
    if b"application/json" in head and length and body:  # a second answer may follow
        file.with_name(f"answer-{file.name}.json").write_bytes(body[: int(length[1])])
