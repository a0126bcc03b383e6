import ast
import inspect
import os
import pathlib

import delio
from delio import _delio

PACKAGE = pathlib.Path(delio.__file__).parent


def test_the_installed_package_is_tested():
    assert PACKAGE.parent == pathlib.Path(os.environ["PYTHONPATH"].split(":")[0])
    assert (PACKAGE / "py.typed").exists()


def public(names):
    return {name for name in names if not name.startswith("_")}


def test_stub_has_every_name_and_argument():
    stub = ast.parse((PACKAGE / "_delio.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    functions = {node.name: node for node in stub.body if isinstance(node, ast.FunctionDef)}
    assert public(dir(_delio)) == set(classes) | set(functions)
    for name, node in classes.items():
        if name == "Error":
            continue
        members = {item.name: item for item in node.body if isinstance(item, ast.FunctionDef)}
        assert public(dir(getattr(_delio, name))) == public(members), name
        functions.update({f"{name}.{member}": item for member, item in members.items()})
    for name, node in functions.items():
        owner, _, member = name.rpartition(".")
        found = getattr(getattr(_delio, owner) if owner else _delio, member)
        if isinstance(found, property) or name.endswith(("__iter__", "__next__", "__len__")):
            continue
        signature = found.__doc__.splitlines()[0]
        for argument in node.args.args + node.args.kwonlyargs:
            assert f"{argument.arg}:" in signature, (name, argument.arg)


def test_every_name_has_a_text():
    for name in public(dir(_delio)):
        of = getattr(_delio, name)
        assert of.__doc__, name
        if inspect.isclass(of) and name != "Error":
            for member in public(dir(of)):
                text = getattr(of, member).__doc__
                assert text and len(text.splitlines()[-1]) > 3, (name, member)


def test_version(tools):
    import subprocess

    told = subprocess.run([tools / "delio-slam", "--version"], capture_output=True, text=True).stdout
    assert delio.__version__ in told
