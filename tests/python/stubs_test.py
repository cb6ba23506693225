"""The stubs and the docstrings say what the package is."""

import ast
import importlib.util
import inspect
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import rigfit

STUB = ast.parse((pathlib.Path(rigfit.__file__).parent / "__init__.pyi").read_text())


def arguments_of(function):
    """(name, default) of each argument in a stub; no default: None."""
    a = function.args
    found = list(zip(a.args, [None] * (len(a.args) - len(a.defaults)) + a.defaults)) + list(zip(a.kwonlyargs, a.kw_defaults))
    listed = [(one.arg, None if default is None else ast.unparse(default)) for one, default in found]
    return listed + ([(a.kwarg.arg, None)] if a.kwarg else [])


def arguments_at_run_time(function):
    return [(p.name, None if p.default is p.empty else repr(p.default))
            for p in inspect.signature(function).parameters.values()]


class Stubs(unittest.TestCase):
    def test_names(self):
        defined = {node.name for node in STUB.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        self.assertEqual(defined, set(rigfit.__all__))

    def test_functions(self):
        for node in STUB.body:
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(arguments_of(node), arguments_at_run_time(getattr(rigfit, node.name)), node.name)
            elif isinstance(node, ast.ClassDef):
                kind = getattr(rigfit, node.name)
                for member in node.body:
                    if isinstance(member, ast.FunctionDef):
                        self.assertTrue(hasattr(kind, member.name), f"{node.name}.{member.name}")
                        if inspect.isfunction(getattr(kind, member.name)):
                            self.assertEqual(arguments_of(member), arguments_at_run_time(getattr(kind, member.name)),
                                             f"{node.name}.{member.name}")

    def test_by_mypy(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is not installed")
        with tempfile.TemporaryDirectory() as folder:
            # The stubs are checked, not what is behind them; pybind11's classes have a metaclass and a constructor of their own.
            settings, known = pathlib.Path(folder) / "mypy.ini", pathlib.Path(folder) / "known"
            modules = [file.stem for file in pathlib.Path(rigfit.__file__).parent.glob("*.py") if file.stem != "__init__"]
            settings.write_text("[mypy]\nignore_missing_imports = True\n" +
                                "".join(f"[mypy-rigfit.{name}]\nignore_errors = True\n" for name in modules))
            known.write_text("rigfit\\.FrfSet(\\.__init__)?\n" + "".join(f"rigfit\\.{name}\\..*\n" for name in modules))
            run = subprocess.run([sys.executable, "-m", "mypy.stubtest", "rigfit", "--concise", "--ignore-unused-allowlist",
                                  "--mypy-config-file", settings, "--allowlist", known], cwd=folder, capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_docstrings(self):
        for name in rigfit.__all__:
            thing = getattr(rigfit, name)
            self.assertTrue(thing.__doc__, name)
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    self.assertTrue(inspect.getdoc(value), f"{name}.{member}")
            if not inspect.isfunction(thing):
                continue
            text = thing.__doc__
            self.assertRegex(text, r"Parameters\n    -+\n")
            self.assertRegex(text, r"Returns\n    -+\n")
            for argument in inspect.signature(thing).parameters:
                self.assertTrue(re.search(rf"(^|\W){argument}\b", text), f"{name}: {argument} is not described")


if __name__ == "__main__":
    unittest.main()
