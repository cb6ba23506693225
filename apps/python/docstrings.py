"""The parameters in the docstrings of the package, made from what the C++ verbs say of their options.

usage: docstrings.py PROGRAM      PROGRAM: build/release/apps/rigfit

Rewrites apps/python/rigfit/*.py in place. Of each parameter that is an option of the verb the first paragraph is the option's
text, range and default; its type and further paragraphs are kept, as is all of what is no option. A test holds the files
against this.
"""

import ast
import pathlib
import re
import subprocess
import sys
import textwrap

FOLDER = pathlib.Path(__file__).resolve().parent / "rigfit"
FILES = ("fits", "laboratory", "model", "recordings", "spectra")
#: functions of verbs by another name, and arguments of options by another name
VERBS = {"inspect": "inspect", "read": "inspect", "resample": "resample", "decay": "decay", "frf": "frf", "modal": "modal",
         "bending": "bending", "axial": "axial", "tension": "tension", "tension_table": "tension", "modes": "modes",
         "respond": "respond", "update": "update", "predict": "predict", "synthesize": "synthesize", "report": "report"}
RENAMED = {"fit": "from", "false_mode": "false"}


def options_of(program, verb):
    """Name to text, range and default of each option, as the verb's help says them."""
    text = subprocess.run([program, verb, "--help"], capture_output=True, text=True, check=True).stdout
    found = {}
    lines = text.split("\n")
    for line, following in zip(lines, lines[1:]):
        name = re.match(r"  --([\w-]+)", line)
        if not name:
            continue
        below = re.match(r" {30}\S", following)  # where the column of options is too narrow
        kind, words = (line, following[30:]) if below else (line[:30], line[30:])
        limits = re.search(r" in \[(\S+) - (\S+)\]", kind)
        default = re.search(r"[A-Z}\]]=([^A-Z\s]\S*)", kind)
        more = [f"{limits[1]} to {limits[2]}"] if limits else []
        more += [f"default {default[1]}"] if default else []
        words = re.sub(r"--([a-z][\w-]*)", lambda m: f"`{m[1].replace('-', '_')}`", words)
        found[name[1]] = words + (f" ({'; '.join(more)})" if more else "") + "."
    return found


def entries(section):
    """Name to (type, paragraphs) of a section of a docstring."""
    found = {}
    for names, kind, body in re.findall(r"^    (\*{0,2}\w[\w, ]*)( : .*)?\n(?!    -)((?:        .*\n|\n(?=        ))*)", section, re.M):
        for name in names.split(", "):
            found[name] = (kind, body.rstrip("\n").split("\n\n"))
    return found


def section(title, names, known, options):
    """The section of these parameters."""
    lines = [f"    {title}", "    " + "-" * len(title)]
    for name in names:
        kind, paragraphs = known[name]
        text = options.get(RENAMED.get(name, name).replace("_", "-"))
        if text:
            paragraphs = ["\n".join(textwrap.wrap(text, 118, initial_indent=" " * 8, subsequent_indent=" " * 8)), *paragraphs[1:]]
        lines += [f"    {name}{kind}"] + ["\n\n".join(paragraphs)] * any(paragraphs)
    return "\n".join(lines) + "\n"


def rewritten(source, program):
    """A file with the docstrings of its functions as they should be."""
    functions = {f.name: f for f in ast.parse(source).body if isinstance(f, ast.FunctionDef)}
    for name in VERBS.keys() & functions.keys():
        function, options = functions[name], options_of(program, VERBS[name])
        old = ast.get_docstring(function, clean=False)
        parts = re.split(r"(?m)^(?=    [A-Z][\w ]*\n    -+\n)", old)
        known = {key: value for part in parts[1:3] for key, value in entries(part).items()}
        arguments = [a.arg for a in function.args.args + function.args.kwonlyargs]
        new = section("Parameters", arguments + ["**hits"] * bool(function.args.kwarg), known, options)
        rest = parts[2:]
        if function.args.kwarg:
            others = [a.arg for a in functions["_hit_options"].args.kwonlyargs if a.arg not in arguments]
            new += "\n" + section("Other Parameters", others, known, options)
            rest = parts[3:]
        source = source.replace(old, parts[0] + new + "\n" + "".join(rest), 1)
    return source


if __name__ == "__main__":
    for file in FILES:
        path = FOLDER / f"{file}.py"
        path.write_text(rewritten(path.read_text(), sys.argv[1]))
