"""Equations as MathML, made when the site is built: browsers draw it without any script.

Chromium needs a font with a table of mathematical metrics to do it well, and many systems have
none. The site therefore brings STIX Two Math along, out of the package `ziamath`.
"""

from __future__ import annotations

import html
import re
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files

FONT = "STIXTwoMath-Regular.ttf"
_EQUATION = re.compile(
    r'<(?P<tag>span|div) class="arithmatex">\\[(\[](?P<tex>.+?)\\[)\]]</(?P=tag)>', re.DOTALL
)
_TOUCHED_UP = {
    # left as written by latex2mathml, after \Bigl
    r">\lbrace<": ">{<",
    r">\rbrace<": ">}<",
    # bars that enclose and slashes are set tight
    '<mo stretchy="false">&#x0007C;</mo>': '<mo stretchy="false" lspace="0" rspace="0">|</mo>',
    "<mo>&#x0002F;</mo>": '<mo lspace="0" rspace="0">/</mo>',
    # browsers know no <menclose> any more; a border does the same
    '<menclose notation="box">': '<mrow class="boxed">',
    "</menclose>": "</mrow>",
}
_PRIMED = re.compile(r"<msup>(<mi>[^<]*</mi>)<mi>(&#x0203[23];)</mi></msup>")
"""Primes are high up and small by themselves; as superscripts they would be so twice."""


def on_files(files: Files, config: Any) -> Files:
    """Add the font."""
    files.append(File.generated(config, FONT, abs_src_path=_font()))
    return files


def on_page_content(text: str, page: Any, **_: Any) -> str:
    """Replace what Arithmatex has marked as an equation."""
    return _EQUATION.sub(lambda found: mathml(found, page.file.src_uri), text)


def mathml(found: re.Match[str], where: str) -> str:
    """One equation; a command that is not known stops the build."""
    tex = html.unescape(found["tex"]).strip()
    block = found["tag"] == "div"
    try:
        drawn = convert(tex, display="block" if block else "inline")
    except Exception as error:
        raise PluginError(f"{where}: {tex}: {error!r}") from error
    for written, meant in _TOUCHED_UP.items():
        drawn = drawn.replace(written, meant)
    drawn = _PRIMED.sub(r'<mrow>\1<mo lspace="0" rspace="0">\2</mo></mrow>', drawn)
    if "\\" in drawn:
        raise PluginError(f"{where}: a command in {tex} was not understood")
    return f'<div class="equation">{drawn}</div>' if block else drawn


def _font() -> str:
    return str(Path(str(distribution("ziamath").locate_file("ziamath/fonts"))) / FONT)
