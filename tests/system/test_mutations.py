"""The deliberate breaks of tests/mutations.toml fit the code; tools/run_mutations.py runs them."""

import ast
import subprocess
import sys
from collections import Counter
from functools import cache

from tools.run_mutations import ROOT, read_mutations

MUTATIONS = read_mutations()


@cache
def text_of(file):
    return (ROOT / file).read_text(encoding="utf-8")


@cache
def functions_of(file):
    """Names of the functions of a file, and whether they are parametrised tests."""
    functions = [n for n in ast.parse(text_of(file)).body if isinstance(n, ast.FunctionDef)]
    return {
        each.name: any("parametrize" in ast.unparse(mark) for mark in each.decorator_list)
        for each in functions
    }


def label(mutation):
    return f"{mutation.file}: {mutation.what}"


def test_mutations_are_sorted_and_all_different():
    assert [each.file for each in MUTATIONS] == sorted(each.file for each in MUTATIONS)
    for key in ("file", "what"), ("file", "old", "new"):
        counts = Counter(tuple(getattr(each, name) for name in key) for each in MUTATIONS)
        assert counts.most_common(1)[0][1] == 1, counts.most_common(1)


def test_the_text_to_replace_occurs_exactly_once():
    for each in MUTATIONS:
        assert text_of(each.file).count(each.old) == 1, label(each)
        assert each.old != each.new, label(each)


def test_mutated_modules_can_be_parsed():
    for each in MUTATIONS:
        if each.file.endswith(".py"):
            ast.parse(text_of(each.file).replace(each.old, each.new), label(each))


def test_the_named_tests_exist():
    for each in MUTATIONS:
        file, _, name = each.test.partition("::")
        function, bracket, _ = name.partition("[")
        assert function in functions_of(file), label(each)
        assert functions_of(file)[function] or not bracket, label(each)


def test_the_list_of_mutations_is_printed():
    command = [sys.executable, "-m", "tools.run_mutations", "--list", "--sample", "3"]
    printed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert printed.count("::test_") == 3
