#!/usr/bin/env python3
"""The type stub has exactly the names of the compiled part, and each has a docstring."""
import ast
import inspect
import pathlib
import re
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


def is_property(function):
    return any(not isinstance(each, ast.Name) or each.id == "property" for each in function.decorator_list)


def docstring_arguments(function):
    """Parses pybind11's signature in the docstring: positional names, keyword-only names, whether any more are
    allowed."""
    signature = inspect.getdoc(function).splitlines()[0]
    inside = signature[signature.index("("):signature.rindex(") ->")]
    positional, _, keyword = inside.partition(", *, ")
    names = [re.findall(r"(?:^|[(, ])(\w+): ", part) for part in (positional, keyword)]
    return [name for name in names[0] if name != "self"], names[1], "**" in inside


class Stub(unittest.TestCase):
    def test_has_the_modules_names(self):
        self.assertEqual(stub_names(STUB.body), public(vars(_vantage)))

    def test_has_the_members_of_each_class(self):
        for node in STUB.body:
            if isinstance(node, ast.ClassDef) and not node.name.endswith("Error"):
                members = {name for name in vars(getattr(_vantage, node.name)) if not name.startswith("_")}
                self.assertEqual(stub_names(node.body), members, node.name)

    def test_has_the_arguments_of_each_function(self):
        compared = set()
        for owner, of in [(_vantage, STUB.body)] + [(getattr(_vantage, node.name), node.body) for node in STUB.body
                                                    if isinstance(node, ast.ClassDef)]:
            for each in of:
                if not isinstance(each, ast.FunctionDef) or is_property(each):
                    continue
                name = f"{getattr(owner, '__qualname__', '')}.{each.name}"
                positional, keyword, takes_any = docstring_arguments(getattr(owner, each.name))
                stub_positional = [arg.arg for arg in each.args.args if arg.arg != "self"]
                stub_keyword = [arg.arg for arg in each.args.kwonlyargs]
                if takes_any:  # then the stub may name the keywords or accept any
                    self.assertTrue(stub_keyword or each.args.kwarg, name)
                    keyword = stub_keyword
                self.assertEqual((stub_positional, stub_keyword), (positional, keyword), name)
                compared.add(name)
        self.assertLessEqual({"Trial.__init__", "TargetModel.__init__", "Problem.parse", ".decide"}, compared)

    def test_parses_the_signatures_of_pybind11(self):
        def function():
            """f(self: m.C, a: Dict[str, function] = {}, b: float = 1.0, *, c: object = None, **kwargs) -> None"""
        self.assertEqual(docstring_arguments(function), (["a", "b"], ["c"], True))

    def test_plan_has_the_signature_of_planner_plan(self):
        arguments = {node.name: node.args.kwonlyargs for node in STUB.body if isinstance(node, ast.FunctionDef)}
        planner = next(node for node in STUB.body if getattr(node, "name", "") == "Planner").body[0]
        self.assertEqual([arg.arg for arg in arguments["plan"]],
                         [arg.arg for arg in planner.args.args[1:] + planner.args.kwonlyargs])

    def test_every_public_name_has_a_docstring(self):
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
