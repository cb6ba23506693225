"""The stubs and the docstrings say what the package is."""

import ast
import importlib.util
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import rigfit

SOURCE, PROGRAM = pathlib.Path(os.environ["RIGFIT_SOURCE"]) / "apps/python", os.environ["RIGFIT_PROGRAM"]
sys.path.insert(0, str(SOURCE))
import docstrings  # noqa: E402

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


def documented(function):
    """Name to (type, text) of what a docstring lists as parameters."""
    parts = re.split(r"(?m)^(?=    [A-Z][\w ]*\n    -+\n)", function.__doc__)
    listed = {}
    for part in parts:
        if re.match("    (Other )?Parameters\n", part):
            listed.update({name: (kind.removeprefix(" : "), " ".join(" ".join(body).split()))
                           for name, (kind, body) in docstrings.entries(part).items()})
    return listed


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

    def test_parameters_are_those_of_the_verbs(self):
        # Text, range and default of every parameter that is an option are what the program's help says of it.
        for file in docstrings.FILES:
            source = (SOURCE / f"rigfit/{file}.py").read_text()
            self.assertEqual(source.splitlines(), docstrings.rewritten(source, PROGRAM).splitlines(),
                             f"{file}.py: run apps/python/docstrings.py")

    def test_every_option_is_an_argument(self):
        common = {"json", "quiet", "plot", "show", "help"}
        # What takes tables that the program alone looks through, and what the result gives without a file.
        left_out = {"tension": {"table", "out"}, "update": {"out"}}
        reading = {"format", "decimal", "separator", "time-unit", "variable"}  # of `read`, for all
        for name, verb in docstrings.VERBS.items():
            if name in ("read", "tension_table"):
                continue
            options = set(docstrings.options_of(PROGRAM, verb)) - common - left_out.get(name, set())
            options -= reading if verb != "synthesize" else set()
            arguments = set(documented(getattr(rigfit, name)))
            missing = options - {docstrings.RENAMED.get(a, a).replace("_", "-") for a in arguments}
            # Numbers of these do not depend on threads or seed.
            self.assertLessEqual(missing, {"threads", "seed"}, name)

    def test_documented_arguments(self):
        # Each argument once, none that is not there, with the stub's type; a number with its unit.
        unit = re.compile(r"\b(Hz|N|m|m4|s|mm|kg|kg/m|N/m|m/N|N m2|Pa|1/s|dB|pt|degrees|[Ss]econds|[Ss]amples a second)\b|%|1/s|"
                          r"[Rr]elative|[Rr]atio|[Pp]robabilit|[Ff]actor|level|unit shape")
        for node in STUB.body:
            if not isinstance(node, ast.FunctionDef):
                continue
            function, listed = getattr(rigfit, node.name), documented(getattr(rigfit, node.name))
            arguments = {a.arg: a.annotation for a in node.args.args + node.args.kwonlyargs}
            self.assertEqual([a for a in listed if a in arguments], list(arguments), node.name)
            others = set(listed) - set(arguments) - {"**hits"}
            self.assertEqual(others, set() if not node.args.kwarg else
                             set(inspect.signature(rigfit.spectra._hit_options).parameters) - {"options", "files", "response"})
            for argument, (kind, text) in listed.items():
                with self.subTest(function=node.name, argument=argument, kind=kind, text=text):
                    annotation = ast.unparse(arguments[argument]) if argument in arguments else ""
                    if argument in arguments:
                        default = inspect.signature(function).parameters[argument].default
                        self.assertEqual(default is None, kind.endswith("optional"))
                    choices = re.fullmatch(r"Literal\[(.*?)\]( \| None)?", annotation)
                    if choices:
                        self.assertEqual(ast.literal_eval(f"({choices[1]},)"), ast.literal_eval(f"({kind[1:kind.index('}')]},)"))
                    elif annotation.partition(" ")[0] in ("bool", "int", "float") and "tuple" not in annotation:
                        self.assertEqual(annotation.partition(" ")[0], re.match(r"\w+", kind)[0])
                    if kind.startswith(("float", "(float")):
                        self.assertRegex(text, unit)
                    if kind.startswith(("int", "bool", "float")):
                        self.assertTrue(text)


if __name__ == "__main__":
    unittest.main()
