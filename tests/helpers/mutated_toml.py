"""Mutations of TOML texts: values, keys, tables and characters, drawn from a generator."""

import copy
import math

ODD_TEXTS = [
    "-1", "0", "1", "2", "1e308", "-1e308", "1e-308", "nan", "inf", "-inf", "true", '""', '"x"',
    '"a\\u0000b"', f'"{"n" * 300}"', '"/dev/zero"', '"."', "[]", "[[]]", "{}", "[1.0]", "[1, 2, 3]",
    '["1", "2", "3"]', "[true, true, true]", "[0, 0, 0, 0]", "1979-05-27", "07:32:00", '{x = 1}',
    f"1{'0' * 400}", f"1{'0' * 5000}", f"0x{'f' * 6000}", "9223372036854775808", "1000000",
    "1000", "1e6", "[1e5, 0, 0]", "[1e308, 0, 0]", "[nan, 0, 0]", f"{'[' * 40}{']' * 40}",
    f"{'[' * 4000}", '"0"', "[[0, 0, 0], [1, 1, 1]]",
]  # fmt: skip


class Verbatim(str):
    """A TOML value as text."""

    __slots__ = ()


def dumped(value):
    """A value as TOML text; tables inline."""
    if isinstance(value, Verbatim):
        return str(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {dumped(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(dumped, value)) + "]"
    return repr(value)


def text_of(data):
    """A TOML document, one line for each key of the top level."""
    return "\n".join(f"{key} = {dumped(value)}" for key, value in data.items()) + "\n"


def places(value, path=()):
    """Paths of all values inside, tables and lists included."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in items:
        yield (*path, key)
        if isinstance(each, (dict, list)):
            yield from places(each, (*path, key))


def mutated(data, rng):
    """A document with one or two mutations, as text."""
    data = copy.deepcopy(data)
    for _ in range(int(rng.choice([1, 1, 2]))):
        _change(data, rng)
    text = text_of(data)
    return _with_other_characters(text, rng) if rng.random() < 0.15 else text


def _change(data, rng):
    paths = list(places(data))
    path = paths[int(rng.integers(len(paths)))]
    holder = data
    for step in path[:-1]:
        holder = holder[step]
    key, kind = path[-1], int(rng.choice([0, 1, 2, 2, 2, 2, 3, 4, 5]))
    value = holder[key]
    if kind <= 1:
        holder[key] = Verbatim(ODD_TEXTS[int(rng.integers(len(ODD_TEXTS)))])
    elif kind == 2 and isinstance(value, (int, float)) and not isinstance(value, (bool, Verbatim)):
        factors = [rng.uniform(0.3, 3.0), 10.0 ** int(rng.integers(-12, 13)), -1.0]
        scaled = value * float(rng.choice(factors, p=[0.7, 0.2, 0.1]))
        whole = isinstance(value, int) and math.isfinite(scaled)
        holder[key] = int(scaled) if whole else float(scaled)
    elif kind == 3:
        del holder[key]
    elif kind == 4 and isinstance(holder, dict):
        holder[key[:-1] + str(rng.choice(list("xs_")))] = holder.pop(key)
    elif isinstance(value, (dict, list)):
        holder[key] = {"inner": value} if rng.random() < 0.5 else [value]
    else:
        other = paths[int(rng.integers(len(paths)))]
        target = data
        for step in other[:-1]:
            target = target[step]
        if other[-1] in target if isinstance(target, dict) else other[-1] < len(target):
            target[other[-1]] = copy.deepcopy(value)


def _with_other_characters(text, rng):
    """Lines doubled or cut short, a byte order mark, line ends of Windows, or odd characters."""
    lines = text.splitlines()
    at = int(rng.integers(len(lines)))
    choice = int(rng.integers(5))
    if choice == 0:
        lines.insert(at, lines[at])
    elif choice == 1:
        lines[at] = lines[at][: len(lines[at]) // 2]
    elif choice == 2:
        return "\ufeff" + text
    elif choice == 3:
        return "\r\n".join(lines)
    else:
        lines[at] += str(rng.choice(["\x00", "\x07", "\u2028", "]", "=", "\ud7ff"]))
    return "\n".join(lines)
