#!/usr/bin/env python3
"""The type stub names what the compiled part has, no less and no more; and each has a docstring."""
import ast
import inspect
import pathlib
import unittest

import vantage
from vantage import _vantage

STUB = ast.parse((pathlib.Path(vantage.__file__).parent / "_vantage.pyi").read_text())


def public(names):
    return {name for name in names if not name.startswith("__")}


def stub_names(body):
    out = set()
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            out.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            out.add(node.target.id)
    return public(out)


class Stub(unittest.TestCase):
    def test_has_the_modules_names(self):
        self.assertEqual(stub_names(STUB.body), public(vars(_vantage)))

    def test_has_the_members_of_each_class(self):
        for node in STUB.body:
            if isinstance(node, ast.ClassDef) and not node.name.endswith("Error"):
                members = {name for name in vars(getattr(_vantage, node.name)) if not name.startswith("_")}
                self.assertEqual(stub_names(node.body), members, node.name)

    def test_has_the_arguments_of_each_function(self):
        compared = 0
        for node in ast.walk(STUB):
            if isinstance(node, ast.ClassDef):
                functions = [(getattr(_vantage, node.name), each) for each in node.body]
            elif isinstance(node, ast.Module):
                functions = [(_vantage, each) for each in node.body]
            else:
                continue
            for owner, each in functions:
                if not isinstance(each, ast.FunctionDef) or each.decorator_list:
                    continue
                said = inspect.getdoc(getattr(owner, each.name)).splitlines()[0]  # pybind11's signature
                if "**" in said or (isinstance(node, ast.ClassDef) and each.name.startswith("__")):
                    continue
                arguments = [arg.arg for arg in each.args.args + each.args.kwonlyargs if arg.arg != "self"]
                for argument in arguments:
                    self.assertIn(f"{argument}: ", said)
                compared += 1
        self.assertGreater(compared, 20)

    def test_every_public_name_says_what_it_is(self):
        for name in vantage.__all__:
            thing = getattr(vantage, name)
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isclass(thing):
                for member, value in vars(thing).items():
                    if callable(value) and not member.startswith("_"):
                        text = inspect.getdoc(value)
                        self.assertTrue(text and len(text.splitlines()) > 1 or not text.startswith(member),
                                        f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
