"""Signatures with defaults below settings classes on the API pages.

mkdocstrings reads the source, where the constructor of a settings class is made by a decorator; the
signature is therefore taken from the imported class.
"""

from __future__ import annotations

import dataclasses
import importlib
import re
from typing import Any

_DIRECTIVE = re.compile(r"^::: (?P<name>ffsr_plan[\w.]*)\n(?:    .*\n)*", re.MULTILINE)


def on_page_markdown(text: str, page: Any, **_: Any) -> str:
    """Add the signature of each class whose fields have defaults."""
    if not page.file.src_uri.startswith("api/"):
        return text
    return _DIRECTIVE.sub(_with_signature, text if text.endswith("\n") else f"{text}\n")


def _with_signature(directive: re.Match[str]) -> str:
    module, _, name = directive["name"].rpartition(".")
    thing: Any = getattr(importlib.import_module(module), name, None)
    if not hasattr(thing, "__pydantic_config__"):  # set by `core.settings.settings`
        return directive[0]
    fields = [field for field in dataclasses.fields(thing) if field.init]
    if all(field.default is dataclasses.MISSING for field in fields):
        return directive[0]
    lines = [f"    {field.name}{_default(field)}," for field in fields]
    signature = "\n".join([f"{name}(", *lines, ")"])
    return (
        f"{directive[0]}\nArguments of `{name}` with their defaults:\n\n```py\n{signature}\n```\n"
    )


def _default(field: dataclasses.Field[Any]) -> str:
    if field.default is not dataclasses.MISSING:
        value = getattr(field.default, "value", field.default)  # a mode by its text
        return f"={value!r}"
    return "=..." if field.default_factory is not dataclasses.MISSING else ""
