"""Headless Chromium, controlled through its debugging socket."""

import asyncio
import base64
import json
import shutil
import subprocess
import time
import urllib.request
from contextlib import contextmanager

from tornado.websocket import websocket_connect

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--window-size=1280,720",
]
_TIMEOUT = 60.0  # [s]


class Tab:
    """One page."""

    def __init__(self, address):
        self._address = address

    def ask(self, expression):
        """The value of a JavaScript expression."""
        answer = asyncio.run(self._call("Runtime.evaluate", expression=expression))
        return answer["result"].get("value")

    def wait_until(self, expression):
        """Wait until a JavaScript expression is true."""
        deadline = time.monotonic() + _TIMEOUT
        while not self.ask(expression):
            assert time.monotonic() < deadline, f"never: {expression}"
            time.sleep(0.1)

    def shoot(self, path):
        """Write a picture of the page."""
        picture = asyncio.run(self._call("Page.captureScreenshot"))
        path.write_bytes(base64.b64decode(picture["data"]))

    async def _call(self, method, **parameters):
        socket = await websocket_connect(self._address, max_message_size=100_000_000)
        await socket.write_message(json.dumps({"id": 1, "method": method, "params": parameters}))
        while True:
            answer = json.loads(await socket.read_message())
            if answer.get("id") == 1:
                socket.close()
                return answer["result"]


@contextmanager
def opened(url, folder):
    """A tab with the page at `url`; the browser keeps its files in `folder`."""
    browser = subprocess.Popen(
        [PROGRAM, *FLAGS, f"--user-data-dir={folder}", "--remote-debugging-port=0", url],
        stderr=subprocess.DEVNULL,
    )
    try:
        deadline, port_file = time.monotonic() + _TIMEOUT, folder / "DevToolsActivePort"
        while not (port_file.exists() and port_file.read_text().count("\n")):
            assert time.monotonic() < deadline, "the browser does not start"
            time.sleep(0.1)
        port = port_file.read_text().split("\n")[0]
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
            tabs = json.load(answer)
        yield Tab(next(t["webSocketDebuggerUrl"] for t in tabs if t["type"] == "page"))
    finally:
        browser.terminate()
        browser.wait(_TIMEOUT)
