"""Open a page in a browser or notebook."""

from __future__ import annotations

import os
import sys
import webbrowser

from ffsr_plan.core.checks import truth
from ffsr_plan.display.web.page_server import PageServer


def in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    return hasattr(_shell(), "kernel")


def at_prompt() -> bool:
    """Whether statements are typed: in a notebook, in IPython or at Python's own prompt."""
    return _shell() is not None or hasattr(sys, "ps1") or bool(sys.flags.interactive)


def open_in_browser(url: str) -> bool:
    """Open a page in the user's browser.

    Returns:
        Whether there is one. Browsers that run in the terminal are not used.
    """
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    if type(browser) is webbrowser.GenericBrowser and "BROWSER" not in os.environ:
        return False  # a browser that runs in the terminal
    return browser.open(url)


def serve(
    page: str, port: int = 0, block: bool | None = None, open_browser: bool | None = None
) -> PageServer:
    """Serve a page on 127.0.0.1.

    Args:
        page: the HTML text.
        port: TCP port; 0 for any free one.
        block: whether to wait for Ctrl-C, which ends the server. By default this is done in
            scripts, because the server ends with the process, and not at a prompt.
        open_browser: whether to open the user's browser; by default it is opened except from a
            notebook, which shows the page itself.

    Returns:
        The server.

    Raises:
        InvalidInput: a port that cannot be used, or a switch that is not True, False or None.
    """
    block = not at_prompt() if block is None else truth("block", block)
    opens = not in_notebook() if open_browser is None else truth("open_browser", open_browser)
    server = PageServer(page, port)
    if opens:
        open_in_browser(server.url)
    if block:
        server.wait(f"{server.url} shows the plan until Ctrl-C")
    return server


def _shell() -> object:
    """IPython's shell, if this process has one."""
    ipython = sys.modules.get("IPython")
    return None if ipython is None else ipython.get_ipython()
