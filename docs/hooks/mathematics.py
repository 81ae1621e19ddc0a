"""Equations as MathML, made when the site is built.

Browsers show MathML without a script. KaTeX or MathJax would have to be copied into the repository,
because the site loads nothing from the network. Chromium needs a font with a table of mathematical
metrics, which many systems lack; the site contains STIX Two Math from the package `ziamath`.
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
_CORRECTIONS = {
    # latex2mathml does not convert these after \Bigl
    r">\lbrace<": ">{<",
    r">\rbrace<": ">}<",
    # no space around enclosing bars and slashes
    '<mo stretchy="false">&#x0007C;</mo>': '<mo stretchy="false" lspace="0" rspace="0">|</mo>',
    "<mo>&#x0002F;</mo>": '<mo lspace="0" rspace="0">/</mo>',
    # browsers no longer support <menclose>; a border looks the same
    '<menclose notation="box">': '<mrow class="boxed">',
    "</menclose>": "</mrow>",
}
_PRIMED = re.compile(r"<msup>(<mi>[^<]*</mi>)<mi>(&#x0203[23];)</mi></msup>")
"""Primes are raised and small already; as superscripts they would be raised twice."""


def on_files(files: Files, config: Any) -> Files:
    """Add the font."""
    files.append(File.generated(config, FONT, abs_src_path=_font()))
    return files


def on_page_content(text: str, page: Any, **_: Any) -> str:
    """Replace the equations that Arithmatex has marked."""
    return _EQUATION.sub(lambda equation: mathml(equation, page.file.src_uri), text)


def mathml(equation: re.Match[str], page: str) -> str:
    """MathML of one equation; an unknown command stops the build."""
    tex = html.unescape(equation["tex"]).strip()
    block = equation["tag"] == "div"
    try:
        result = convert(tex, display="block" if block else "inline")
    except Exception as error:
        raise PluginError(f"{page}: {tex}: {error!r}") from error
    for wrong, right in _CORRECTIONS.items():
        result = result.replace(wrong, right)
    result = _PRIMED.sub(r'<mrow>\1<mo lspace="0" rspace="0">\2</mo></mrow>', result)
    if "\\" in result:
        raise PluginError(f"{page}: unknown command in {tex}")
    return f'<div class="equation">{result}</div>' if block else result


def _font() -> str:
    return str(Path(str(distribution("ziamath").locate_file("ziamath/fonts"))) / FONT)
