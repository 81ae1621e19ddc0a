"""Addresses of mesh files, as URDFs state them: `package://...`, `file://...` and plain paths."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

from ffsr_plan.core.errors import InvalidInput


def find(address: str, folders: Sequence[str]) -> Path | None:
    """Look up a mesh address.

    Nothing is downloaded: an address with another scheme has no file. A `file://` address is
    percent-decoded, relative to the folders if it is no absolute path. A `package://` address is
    decoded if there is no file of its literal name, and backslashes count as slashes if there is
    none otherwise.

    A package is looked up as a folder below each of `folders`, as one of `folders` itself, then
    upwards from the last of them, which is that of the URDF: a folder is the package if it has its
    name, or if its `package.xml` has. Then come the folders of the environment variables
    `ROS_PACKAGE_PATH`, and those of `AMENT_PREFIX_PATH` with `share` below.

    Args:
        address: `package://...`, `file://...` or a plain path.
        folders: folders in which package and relative addresses are looked up, in this order.

    Returns:
        Path of the file; None if there is none.
    """
    scheme, rest = _parts(address)
    if scheme == "file":
        spellings = [unquote(rest), rest]
    elif scheme == "package":
        spellings = [rest, unquote(rest)]
    elif scheme:
        return None
    else:
        spellings = [rest]
    for spelling in [*spellings, *(each.replace("\\", "/") for each in spellings)]:
        places = _in_packages(spelling, folders) if scheme == "package" else ()
        for place in (*_in_folders(spelling, folders), *places):
            if os.path.isfile(place):  # unlike Path.is_file, also for names that are too long
                return Path(place)
    return None


def found(address: str, folders: Sequence[str], where: str) -> Path:
    """Look up a mesh address that has to exist; see `find`.

    Args:
        address: address of the file.
        folders: folders in which it is looked up.
        where: robot and link, for the message.

    Raises:
        InvalidInput: no such file, with the places that were searched.
    """
    path = find(address, folders)
    if path is None:
        raise InvalidInput(where, address, f"an existing file ({_searched(address, folders)})")
    return path


def _parts(address: str) -> tuple[str, str]:
    """Scheme in small letters, empty for a plain path, and the rest of an address."""
    scheme, divider, rest = address.partition("://")
    if divider and re.fullmatch(r"[A-Za-z][A-Za-z0-9+.-]+", scheme):
        local = scheme.lower() == "file" and rest.startswith("localhost/")
        return scheme.lower(), rest.removeprefix("localhost") if local else rest
    if address[:6].lower() == "file:/":
        return "file", address[5:]
    return "", address


def _in_folders(rest: str, folders: Sequence[str]) -> list[str]:
    """An absolute path, or a relative one below each folder."""
    return [rest] if os.path.isabs(rest) else [os.path.join(folder, rest) for folder in folders]


def _in_packages(rest: str, folders: Sequence[str]) -> Iterator[str]:
    """Places of a file `package/inner/path`, other than below the folders themselves."""
    package, _, inner = rest.partition("/")
    if not package or not inner:
        return
    above = [str(parent) for parent in Path(folders[-1]).absolute().parents] if folders else []
    for folder in [*map(os.path.abspath, folders), *above]:
        if _is_package(folder, package):
            yield os.path.join(folder, inner)
    for folder in above:
        yield os.path.join(folder, rest)
    for entry in _listed("ROS_PACKAGE_PATH"):
        if _is_package(entry, package):
            yield os.path.join(entry, inner)
        yield os.path.join(entry, rest)
        yield from (os.path.join(folder, rest) for folder in _folders_in(entry))
    for entry in _listed("AMENT_PREFIX_PATH"):
        yield os.path.join(entry, "share", rest)


def _is_package(folder: str, name: str) -> bool:
    """Whether a folder is the package of a name, by its own name or by its `package.xml`."""
    if os.path.basename(folder) == name:
        return True
    try:
        manifest = ElementTree.parse(os.path.join(folder, "package.xml"))
    except (OSError, ValueError, ElementTree.ParseError):
        return False
    return (manifest.findtext("name") or "").strip() == name


def _folders_in(folder: str) -> list[str]:
    """Folders in a folder, sorted; none if it cannot be read."""
    try:
        with os.scandir(folder) as entries:
            return sorted(entry.path for entry in entries if entry.is_dir())
    except OSError:
        return []


def _listed(variable: str) -> list[str]:
    """Folders of an environment variable."""
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _searched(address: str, folders: Sequence[str]) -> str:
    """Where an address was looked up, in words."""
    scheme, rest = _parts(address)
    if scheme not in ("", "file", "package"):
        return f"nothing is downloaded from {scheme}://"
    folders = [*map(os.path.abspath, folders)]
    places = ", ".join(folders) or "no folder, as none is given"
    if scheme != "package":
        return "there is none" if os.path.isabs(rest) else f"looked for in {places}"
    package = rest.partition("/")[0]
    above = f", the folders above {folders[-1]}" if folders else ""
    variables = " and ".join(
        f"{name} ({os.environ.get(name) or 'not set'})"
        for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
    )
    return (
        f"package '{package}' searched in {places}{above}, {variables}; package_dirs adds folders"
    )
