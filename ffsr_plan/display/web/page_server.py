"""Local web server for one page and its messages."""

from __future__ import annotations

import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from html import escape
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import urlsplit

from ffsr_plan.core.checks import whole_number
from ffsr_plan.core.errors import InvalidInput

HOST = "127.0.0.1"  # not the other addresses of the machine, so that nobody else sees a plan
_NAMES = (HOST, "localhost")
_HEARTBEAT = 5.0  # period [s] of empty messages, which reveal closed connections
_IDLE_TIMEOUT = 30.0  # [s] after which a connection without a request is closed
_STOP_TIMEOUT = 2.0  # [s] that threads have to end
_FRAME_HEIGHT = 540  # in a notebook [px]


class PageServer:
    """Serves one page on 127.0.0.1, and messages to pages that listen.

    It runs from its creation until `stop`, the end of a `with` block or the end of the process. A
    notebook shows it as a frame.

    Attributes:
        url: address of the page.
    """

    def __init__(self, page: str, port: int = 0) -> None:
        """Start the server.

        Args:
            page: the HTML text.
            port: TCP port; 0 for any free one.

        Raises:
            InvalidInput: a port that cannot be used, for example because it is in use.
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
            raise InvalidInput("port", port, f"a free port, or 0 for any ({error})") from None
        self._http.pages = self
        self.url = f"http://{HOST}:{self._http.server_address[1]}/"
        self._thread = threading.Thread(
            target=self._http.serve_forever, args=(0.1,), name="ffsr-plan pages", daemon=True
        )
        self._thread.start()

    def publish(self, message: Callable[[], str]) -> None:
        """Send a message to the listeners, in place of an earlier one that is not yet sent.

        Args:
            message: returns the text, of one line; called only if somebody listens.
        """
        with self._changed:
            self._message, self._number = message, self._number + 1
            self._changed.notify_all()

    def replace(self, page: str, last_message: str, timeout: float = 5.0) -> None:
        """Serve another page from now on, and wait until the listeners have loaded it.

        Args:
            page: the HTML text.
            last_message: text of one line that makes the listeners load the page again.
            timeout: greatest time to wait [s].
        """
        with self._changed:
            self._page, wanted = page.encode(), self._sent + self._listeners
            self.publish(lambda: last_message)
            self._changed.wait_for(lambda: self._sent >= wanted or self._over, timeout)

    def wait_for_listener(self, timeout: float) -> bool:
        """Wait until a page listens, at most `timeout` [s]; return whether one does."""
        with self._changed:
            return self._changed.wait_for(lambda: self._listeners > 0, timeout)

    def wait(self, announcement: str = "") -> None:
        """Wait until the server is stopped, or for Ctrl-C, which stops it.

        Args:
            announcement: printed first, if it is not empty.
        """
        with self, suppress(KeyboardInterrupt):
            if announcement:
                print(announcement, flush=True)
            self._stopped.wait()

    def stop(self) -> None:
        """End all threads and free the port. The message published last is still sent."""
        with self._changed:
            if self._over:
                return
            self._over = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._listeners == 0, _STOP_TIMEOUT)
        self._http.shutdown()
        self._http.server_close()
        self._thread.join(_STOP_TIMEOUT)
        self._http.close_connections()
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
        """The newest message and those after it until the server stops, and "" as a heartbeat."""
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

    def __exit__(self, *error: object) -> None:
        self.stop()

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{escape(self.url)}" width="100%" height="{_FRAME_HEIGHT}" '
            'style="border: 0" allowfullscreen></iframe>'
        )


class _Http(ThreadingHTTPServer):
    """Tracks open connections so that `stop` can close them."""

    daemon_threads = True
    pages: PageServer

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of the base class
        self._connections: dict[threading.Thread, socket.socket] = {}
        super().__init__(*arguments)

    def process_request_thread(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Answer one connection, in a thread of its own."""
        thread = threading.current_thread()
        self._connections[thread] = request
        try:
            super().process_request_thread(request, client_address)
        finally:
            del self._connections[thread]

    def close_connections(self) -> None:
        """Close the connections that are still open, and end their threads."""
        for thread, connection in list(self._connections.items()):
            with suppress(OSError):  # already closed
                connection.shutdown(socket.SHUT_RDWR)
            thread.join(_STOP_TIMEOUT)

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Report an error unless a browser has closed the connection."""
        if not isinstance(sys.exc_info()[1], (ConnectionError, TimeoutError)):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Answers GET requests for the page and its messages."""

    server: _Http
    timeout = _IDLE_TIMEOUT
    server_version, sys_version = "ffsr-plan", ""

    def do_GET(self) -> None:
        path = urlsplit(self.path).path
        if not self._names_this_machine():
            self.send_error(403, "only for 127.0.0.1 and localhost")
        elif path == "/":
            self._send_page()
        elif path == "/events":
            self._send_messages()
        else:
            self.send_error(404)

    def _names_this_machine(self) -> bool:
        """Whether the request names this machine, not a foreign site that resolves to 127.0.0.1."""
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
        """Print nothing."""
