"""`PageServer`: a page for browsers on this machine, served by threads of this process."""

from __future__ import annotations

import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from html import escape
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any
from urllib.parse import urlsplit

from ffsr_plan.core.checks import whole_number
from ffsr_plan.core.errors import InvalidInput

HOST = "127.0.0.1"  # not the machine's other addresses: nobody else is to see a plan
_NAMES = (HOST, "localhost")
_HEARTBEAT = 5.0  # seconds after which a silent listener is asked whether it is still there
_QUIET = 30.0  # seconds that a connection may stay open without a word
_PARTING = 2.0  # seconds that threads have to end
_HEIGHT = 540  # of the frame in a notebook [px]


class PageServer:
    """Serves one page on 127.0.0.1, and messages to those who listen.

    It starts when it is made, and ends with `stop`, at the end of a `with` block, or with the
    process. A notebook shows it as a frame.

    Attributes:
        url: where the page is.
    """

    def __init__(self, page: str, port: int = 0) -> None:
        """Start to serve.

        Args:
            page: the HTML text.
            port: 0 for any that is free.

        Raises:
            InvalidInput: a port that cannot be had, such as one in use.
        """
        port = whole_number("port", port, at_least=0, at_most=65535)
        self._changed = threading.Condition()
        self._page, self._sent, self._listeners = page.encode(), 0, 0
        self._message: Callable[[], str] | None = None
        self._number = 0  # of the message
        self._over = False
        self._stopped = threading.Event()
        try:
            self._http = _Http((HOST, port), _Handler)
        except OSError as error:
            raise InvalidInput("port", port, f"one that is free, 0 for any ({error})") from None
        self._http.pages = self
        self.url = f"http://{HOST}:{self._http.server_address[1]}/"
        self._thread = threading.Thread(
            target=self._http.serve_forever, args=(0.1,), name="ffsr-plan pages", daemon=True
        )
        self._thread.start()

    def publish(self, message: Callable[[], str]) -> None:
        """Send listeners a message of one line, written out when somebody is there to read it.

        It takes the place of an earlier one that has not been sent yet.
        """
        with self._changed:
            self._message, self._number = message, self._number + 1
            self._changed.notify_all()

    def replace(self, page: str, farewell: str, patience: float = 5.0) -> None:
        """Serve another page from now on, and tell listeners, who are to load it again.

        Args:
            page: the HTML text.
            farewell: the message to listeners, of one line.
            patience: most seconds to wait until they have it.
        """
        with self._changed:
            self._page, wanted = page.encode(), self._sent + self._listeners
            self.publish(lambda: farewell)
            self._changed.wait_for(lambda: self._sent >= wanted or self._over, patience)

    def wait_for_listener(self, patience: float) -> bool:
        """Wait until some page listens, `patience` seconds at most; whether one does."""
        with self._changed:
            return self._changed.wait_for(lambda: self._listeners > 0, patience)

    def wait(self) -> None:
        """Wait until the server is stopped, or for Ctrl-C, which stops it."""
        with self, suppress(KeyboardInterrupt):
            self._stopped.wait()

    def stop(self) -> None:
        """End all threads and free the port; what was published last is still sent."""
        with self._changed:
            if self._over:
                return
            self._over = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._listeners == 0, _PARTING)
        self._http.shutdown()
        self._http.server_close()
        self._thread.join(_PARTING)
        self._http.hang_up()
        self._stopped.set()

    def page(self) -> bytes:
        """The page, for the handler of a request."""
        return self._page

    def note_sent(self) -> None:
        """Count a page that has been sent."""
        with self._changed:
            self._sent += 1
            self._changed.notify_all()

    def messages(self) -> Iterator[str]:
        """The latest message, and each one after it, until the server stops; "" now and then."""
        seen = 0
        with self._changed:
            self._listeners += 1
            self._changed.notify_all()
        try:
            while True:
                with self._changed:
                    if self._number == seen and not self._over:
                        self._changed.wait(_HEARTBEAT)
                    fresh, message = self._number != seen, self._message
                    seen = self._number
                if fresh and message is not None:
                    yield message()
                elif self._over:
                    return
                else:
                    yield ""
        finally:
            with self._changed:
                self._listeners -= 1
                self._changed.notify_all()

    def __enter__(self) -> PageServer:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{escape(self.url)}" width="100%" height="{_HEIGHT}" '
            'style="border: 0" allowfullscreen></iframe>'
        )


class _Http(ThreadingHTTPServer):
    """Knows its connections, so that it can hang up."""

    daemon_threads = True
    pages: PageServer

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of the base class
        self._lines: dict[threading.Thread, socket.socket] = {}
        super().__init__(*arguments)

    def process_request_thread(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Answer one connection, in a thread of its own."""
        here = threading.current_thread()
        self._lines[here] = request
        try:
            super().process_request_thread(request, client_address)
        finally:
            del self._lines[here]

    def hang_up(self) -> None:
        """End the connections that are still open, and their threads."""
        for thread, line in list(self._lines.items()):
            with suppress(OSError):  # it has ended by itself
                line.shutdown(socket.SHUT_RDWR)
            thread.join(_PARTING)

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Browsers hang up when they like; that is no error."""
        if not isinstance(sys.exc_info()[1], (ConnectionError, TimeoutError)):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: _Http
    timeout = _QUIET
    server_version, sys_version = "ffsr-plan", ""

    def do_GET(self) -> None:
        path = urlsplit(self.path).path
        if not self._asked_by_name():
            self.send_error(403, "only for 127.0.0.1 and localhost")
        elif path == "/":
            self._send_page()
        elif path == "/events":
            self._send_messages()
        else:
            self.send_error(404)

    def _asked_by_name(self) -> bool:
        """Whether the request names this machine: a site whose name leads here does not."""
        try:
            (host,) = self.headers.get_all("Host", [])
            return urlsplit(f"//{host}").hostname in _NAMES
        except ValueError:
            return False

    def _send_page(self) -> None:
        page = self.server.pages.page()
        self._begin("text/html; charset=utf-8", len(page))
        self.wfile.write(page)
        self.server.pages.note_sent()

    def _send_messages(self) -> None:
        self._begin("text/event-stream", None)
        for message in self.server.pages.messages():
            self.wfile.write(f"data: {message}\n\n".encode() if message else b":\n\n")

    def _begin(self, kind: str, size: int | None) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        if size is not None:
            self.send_header("Content-Length", str(size))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.end_headers()

    def log_message(self, *arguments: object) -> None:
        """Nothing: the terminal is the caller's."""
