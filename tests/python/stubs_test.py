"""Arguments, docstrings and stubs are what the C++ verbs describe; unknown arguments are refused with the nearest name."""

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
from rigfit import _core, described, stubs

STUB = (pathlib.Path(rigfit.__file__).parent / "__init__.pyi").read_text()
VERBS = ("inspect", "resample", "decay", "frf", "modal", "bending", "axial", "tension", "modes", "respond", "update", "predict",
         "synthesize", "report")
#: What a call has in another way: a function of its own, an object of the result.
LEFT_OUT = {"update": {"out"}}


class Described(unittest.TestCase):
    def test_every_option_is_an_argument_with_its_text_and_range(self):
        for verb in VERBS:
            function = getattr(rigfit, verb)
            options = described.options_of(verb)
            self.assertGreater(len(options), 2)
            documented = " ".join(function.__doc__.split())
            for argument, option in options.items():
                if argument in LEFT_OUT.get(verb, ()):
                    continue
                self.assertIn(argument, inspect.signature(function).parameters, verb)
                self.assertIn(" ".join(described._text_of(option).split()), documented, f"{verb}: {argument}")
            self.assertEqual(function.__doc__.count("Returns\n-------"), 1)

    def test_numbers_have_units(self):
        unit = re.compile(r"\b(Hz|N|m|m4|s|mm|kg|kg/m|N/m|m/N|N m2|Pa|1/s|dB|pt|degrees|[Ss]econds|[Ss]amples a second)\b|%|"
                          r"[Rr]elative|[Rr]atio|[Pp]robabilit|[Ff]actor|level|unit shape")
        for verb in VERBS:
            for argument, option in described.options_of(verb).items():
                if option["kind"] == "number":
                    self.assertRegex(option["text"], unit, f"{verb}: {argument}")

    def test_the_nearest_name_is_said(self):
        with self.assertRaises(rigfit.ArgumentError) as caught:
            rigfit.axial("a.csv", mass=1.0, length=1.0, lenght_std=0.1)
        self.assertIn("did you mean length_std?", str(caught.exception))
        with self.assertRaisesRegex(TypeError, "missing"):
            rigfit.axial("a.csv", length=1.0)

    def test_stub_is_what_the_package_is(self):
        self.assertEqual(STUB, stubs.text())
        defined = {node.name for node in ast.parse(STUB).body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        self.assertEqual(defined, set(rigfit.__all__))
        self.assertIn("mass: _Value, mass_std: float | None", STUB)
        self.assertEqual(set(dir(rigfit)), set(rigfit.__all__) | {"__version__"})

    def test_by_mypy(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is not installed")
        with tempfile.TemporaryDirectory() as folder:
            call = pathlib.Path(folder) / "call.py"
            call.write_text("import rigfit\nx = rigfit.axial('a.csv', mass=1.0, length=[1.0]).EA_N.value\nreveal_type(x)\n"
                            "rigfit.axial('a.csv', mass='1', length=1.0)\n")
            run = subprocess.run([sys.executable, "-m", "mypy", "--ignore-missing-imports", call], cwd=folder, capture_output=True,
                                 text=True)
        self.assertIn("float | None", run.stdout.replace("Union[builtins.float, None]", "float | None"))
        self.assertIn('incompatible type "str"', run.stdout)

    def test_docstrings(self):
        for name in rigfit.__all__:
            thing = getattr(rigfit, name)
            self.assertTrue(thing.__doc__, name)
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    self.assertTrue(inspect.getdoc(value), f"{name}.{member}")

    def test_options_are_those_of_the_module(self):
        self.assertEqual(_core.options("no such verb")[0]["name"], "--json")  # the common ones alone


if __name__ == "__main__":
    unittest.main()
