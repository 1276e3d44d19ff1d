"""``slipmargin explore`` on the command line: it ends by Ctrl-C, and frees its port."""

from __future__ import annotations

import http.client
import re
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

#: A process that is begun in the background of a shell ignores Ctrl-C; these do not.
RUN = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from slipmargin_cli.main import run\n"
    "sys.argv = ['slipmargin', 'explore', 'mecanum4', '--no-browser', *sys.argv[1:]]\n"
    "run()\n"
)


@contextmanager
def exploring(*words: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """A page that is served by a process of its own, and its port."""
    process = subprocess.Popen(
        [sys.executable, "-c", RUN, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        address = re.search(r"http://127\.0\.0\.1:(\d+)/", process.stdout.readline())
        assert address is not None and process.stdout.readline() == "Ctrl-C ends it.\n"
        yield process, int(address[1])
    finally:
        process.kill()
        process.communicate()


def get(port: int, path: str = "/") -> int:
    line = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    line.request("GET", path)
    status = line.getresponse().status
    line.close()
    return status


def test_ctrl_c_says_one_line_with_status_130_and_frees_the_port() -> None:
    """It left with status 0 and said nothing; the contract says 130."""
    with exploring() as (first, port):
        assert get(port) == 200
        first.send_signal(signal.SIGINT)
        out, err = first.communicate(timeout=60)
    assert (first.returncode, out) == (130, "")
    assert err == f"stopped: http://127.0.0.1:{port}/ is closed\n"
    with exploring("--port", str(port)) as (_, again):
        assert again == port and get(port) == 200


def test_a_second_page_gets_another_port() -> None:
    with exploring() as (_, one), exploring() as (_, other):
        assert one != other and get(one) == get(other) == 200


def test_a_browser_that_is_closed_is_no_error() -> None:
    """The connection is reset while the answer is on its way, as when a tab is closed."""
    with exploring() as (process, port):
        for _ in range(3):
            line = socket.create_connection(("127.0.0.1", port), timeout=60)
            line.sendall(f"GET /api/limits HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
            line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            line.close()
        assert get(port, "/api/limits") == 200
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and err.count("\n") == 1
