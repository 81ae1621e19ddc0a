"""URDF and SRDF texts parsed, each element with its place in the text.

Namespaces are prefixes here, as they are to urdfdom: a prefix need not be declared, and elements of
other tools keep theirs.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from xml.etree import ElementTree
from xml.parsers import expat

from ffsr_plan.core.errors import InvalidInput

MOST_CHARACTERS = 50_000_000
"""Limit of the length of a URDF or SRDF."""
_DEEPEST = 100
"""Limit of elements inside one another; a URDF needs 6."""
_XACRO = "xacro"
EXPAND = "plain URDF; expand it first: xacro in.xacro > out.urdf"


class PlacedElement(ElementTree.Element):
    """An element with its place in the text.

    Attributes:
        line: from 1; 0 if the element was not read from a text.
        column: from 1; 0 likewise.
    """

    line = 0
    column = 0


def is_comment(element: ElementTree.Element) -> bool:
    """Whether an element is a comment."""
    return not isinstance(element.tag, str)


def refused(element: ElementTree.Element, where: str, value: object, allowed: str) -> InvalidInput:
    """The error for an element's fault, with the element's line and column if it has them.

    Args:
        element: the element at fault.
        where: what is at fault, see `InvalidInput`.
        value: the offending value.
        allowed: what would have been accepted.
    """
    return placed(element, InvalidInput(where, value, allowed))


def placed(element: ElementTree.Element, error: InvalidInput) -> InvalidInput:
    """The error with the element's line and column, if it has them and the error has none yet."""
    line, column = getattr(element, "line", 0), getattr(element, "column", 0)
    if not line or "(line " in error.allowed:
        return error
    place = f"{error.allowed} (line {line}, column {column})"
    return InvalidInput(error.what, error.value, place)


@contextmanager
def placed_errors(element: ElementTree.Element) -> Iterator[None]:
    """Give errors the element's line and column."""
    try:
        yield
    except InvalidInput as error:
        raise placed(element, error) from None


def parse(text: str, where: str) -> ElementTree.Element:
    """Parse a URDF or SRDF. Entities are refused, not expanded.

    Args:
        text: the URDF or SRDF.
        where: file or robot name that starts every message.

    Returns:
        The `<robot>` element; it and all elements below it are `PlacedElement`s.

    Raises:
        InvalidInput: a document type, not XML, too long or too deep, elements of xacro, or another
            element at the top.
    """
    text = text.removeprefix("\ufeff")
    if len(text) > MOST_CHARACTERS:
        raise InvalidInput(where, f"{len(text)} characters", f"at most {MOST_CHARACTERS}")
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InvalidInput(where, "a DOCTYPE or ENTITY", "plain XML without a document type")
    try:
        root = _Builder(where).read(text)
    except (expat.ExpatError, UnicodeEncodeError) as error:
        raise InvalidInput(where, str(error), "well-formed XML") from None
    if root.tag != "robot":
        raise refused(root, where, f"<{root.tag}>", "a <robot> element at the top")
    return root


class _Builder:
    """Builds placed elements from what expat finds."""

    def __init__(self, where: str) -> None:
        self._where = where
        self._parser = expat.ParserCreate(encoding="utf-8")
        self._tree = ElementTree.TreeBuilder(PlacedElement, insert_comments=True)
        self._xacro = [frozenset({_XACRO})]  # prefixes of xacro at each depth
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._tree.data
        self._parser.CommentHandler = self._comment

    def read(self, text: str) -> ElementTree.Element:
        """The root element of a text."""
        self._parser.Parse(text.encode("utf-8"), True)
        return self._tree.close()

    def _comment(self, text: str) -> None:
        if len(self._xacro) > 1:  # inside the root element
            self._tree.comment(text)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        place = self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber + 1
        prefixes = self._xacro[-1] | {
            key.partition(":")[2]
            for key, value in attributes.items()
            if key.partition(":")[0] == "xmlns" and value.rstrip("/").endswith("/" + _XACRO)
        }
        names = [tag, *(key for key in attributes if ":" in key)]
        used = [name for name in names if _prefix(name) in prefixes]
        if used or len(self._xacro) > _DEEPEST:
            found = f"<{tag}>" if not used or used[0] == tag else f"<{tag} {used[0]}>"
            deep = f"at most {_DEEPEST} elements inside one another"
            allowed = f"{EXPAND if used else deep} (line {place[0]}, column {place[1]})"
            raise InvalidInput(self._where, found, allowed)
        self._xacro.append(prefixes)
        element = self._tree.start(tag, attributes)
        element.line, element.column = place  # type: ignore[attr-defined]

    def _end(self, tag: str) -> None:
        self._xacro.pop()
        self._tree.end(tag)


def _prefix(name: str) -> str:
    """The prefix of a name; empty without one, as of a default namespace."""
    return name.partition(":")[0] if ":" in name else ""
