"""Functions of the program's verbs: their arguments, checks and docstrings are walks over the options that the C++ verbs describe
(`_core.options`). A new option is a keyword here without another line."""

import difflib
import functools
import inspect
import numbers
import os
import re
import textwrap

import numpy as np

from . import _core, checks, errors
from .recordings import warn
from .results import Estimate

#: Options whose names are words of Python or say nothing without the command line.
_RENAMED = {"from": "fit", "false": "false_mode"}
#: What stands first in a call: in the words of a docstring and of a stub.
_FIRST = {"recordings": ("path, Recording, list of channels, or list of these", "_Sources"),
          "recording": ("path, Recording or list of channels", "_Source"),
          "frfs": ("FrfResult, FrfSet, path of a file of FRFs, or recordings of hits (then with ``force``)", "FrfResult | FrfSet | _Sources"),
          "scene": ("Scene, path or TOML text, in `update` also a list of these", "_SceneLike | Sequence[_SceneLike]"),
          "campaign": ("path, or (path, path) to be compared", "_Path | Sequence[_Path]")}
#: Options of the command line that a call has in another way.
_LEFT_OUT = {"json", "quiet", "verbose"}


@functools.lru_cache(None)
def options_of(verb):
    """Option by argument: what it is, in order; without those that stand by their place."""
    found = {}
    for option in _core.options(verb):
        if option["name"].startswith("--"):
            option["key"] = option["name"][2:].replace("-", "_")
            if option["key"] not in _LEFT_OUT:
                found[_RENAMED.get(option["key"], option["key"])] = option
    for key, option in found.items():  # a number whose std is an option too may be given as (value, std)
        option["std"] = found.get(f"{key}_std", {}).get("key") if option["kind"] == "number" else None
    return found


def parted(argument, value):
    """Value and std of a pair, an Estimate or a ufloat; of anything else itself and None."""
    if isinstance(value, Estimate):
        return value.value, value.std
    if hasattr(value, "nominal_value") and hasattr(value, "std_dev"):
        return value.nominal_value, value.std_dev
    if not isinstance(value, (tuple, list)):
        return value, None
    if len(value) != 2:
        checks.fail(argument, "must be a number or (value, std)")
    return value


def plain(argument, option, value):
    """A value as JSON has it: whether the option takes it is said where it is filled."""
    if option["written"]:
        return checks.new_file(argument, value)
    if hasattr(value, "__fspath__"):
        value = checks.path(argument, value)
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(f"{argument}[{i}]", option, one) for i, one in enumerate(value)]
    if isinstance(value, str):
        return checks.text(argument, value)
    if isinstance(value, int):
        return value
    if not isinstance(value, numbers.Real):
        checks.fail(argument, f"must be {_type_of(option)[0]}, not {checks.kind(value)}")
    return checks.number(argument, value)


def _type_of(option):
    """In the words of a docstring and of a stub."""
    words = [repr(word) for word in option["words"]]
    kind = option["kind"]
    if kind == "number" and (words or option.get("std")):
        shown, types = ("float or (value, std)", "_Value") if option.get("std") else ("float", "float")
        return (" or ".join([shown, *words]).replace("'", '"'), types + (f" | Literal[{', '.join(words)}]" if words else ""))
    if kind in ("flag", "integer", "number"):
        return {"flag": ("bool", "bool"), "integer": ("int", "int"), "number": ("float", "float")}[kind]
    if kind == "numbers":
        n = option["numbers"]
        return (f"({', '.join(['float'] * n)})", f"tuple[{', '.join(['float'] * n)}]") if n else \
            ("float or list of float", "float | Sequence[float]")
    if kind == "texts":
        return ("str or list of str", "str | Sequence[str]")
    if words:
        return ("{" + ", ".join(words).replace("'", '"') + "}", f"Literal[{', '.join(words)}]")
    if option["written"]:
        return ("path", "_Path")
    return ("str", "str")


def _text_of(option):
    """Meaning, range and default, with arguments in place of options."""
    more = [f"{option['lowest']:g} to {option['highest']:g}"] if option["highest"] < 1e300 else []
    more += [f"default {option['default']}"] if option["default"] else []
    text = re.sub(r"--([a-zA-Z][\w-]*)", lambda m: f"`{m[1].replace('-', '_')}`", option["text"])
    return text + (f" ({'; '.join(more)})" if more else "") + "."


def in_arguments(text):
    """A message with arguments in place of options of the command line, but for commands in backticks."""
    return re.sub(r"`[^`]*`|--([a-z][a-z-]*)", lambda m: f"`{m[1].replace('-', '_')}`" if m[1] else m[0], text)


def call(function, *arguments):
    """Calls the module; options of the command line in what it raises become names of arguments."""
    try:
        return function(*arguments)
    except errors.Error as error:
        error.message = in_arguments(error.message)
        error.args = (error.message,)
        error.problem, error.remedy = in_arguments(error.problem), in_arguments(error.remedy)
        raise


def finish(kind, document, exit_code, printed="", **extra):
    """The result of a call; a refusal or a failure to converge raises, with what can be had as its ``result``."""
    result = kind(document, printed=printed, **extra)
    if exit_code == 0:
        warn(document["warnings"])
        return result
    found = document["error"]
    where, problem = f"{found['where']}: " if found["where"] else "", in_arguments(found["message"])
    error = (errors.Refused if exit_code == 4 else errors.NotConverged)(
        f"{where}{problem}", code=found["code"], where=found["where"], problem=problem, result=result)
    if hasattr(error, "add_note"):  # from Python 3.11 on
        error.add_note(f"The exception's `result` ({kind.__name__}) has what can be had all the same.")
    raise error


def verb(name, result, raw=None, without=()):
    """Makes ``function(own arguments, options)`` the function of a verb.

    Its own arguments that are options may be given by place; all others are keywords. ``raw``: type by argument that the function
    checks itself. The function returns what `finish` takes: document, exit code, text, and a dict of what else the result has.
    """
    raw = raw or {}

    def made(function):
        options = {key: one for key, one in options_of(name).items() if key not in without}
        own = [p for p in inspect.signature(function).parameters.values() if p.name not in ("options", "folder")]
        placed = {p.name for p in own}

        def types(key):
            return (raw[key].replace(" | ", " or "), raw[key]) if key in raw else _type_of(options[key]) if key in options else _FIRST[key]
        parameters = [p.replace(annotation=types(p.name)[1]) for p in own]
        for key, one in options.items():
            if key not in placed:
                empty, kind = one["required"], types(key)[1]
                parameters.append(inspect.Parameter(
                    key, inspect.Parameter.KEYWORD_ONLY, default=inspect.Parameter.empty if empty else None,
                    annotation=kind if empty else f"{kind} | None"))
        parameters.sort(key=lambda p: p.kind)
        signature = inspect.Signature(parameters, return_annotation=result.__name__)

        @functools.wraps(function)
        def called(*arguments, **keywords):
            for key in keywords:
                if key not in signature.parameters:
                    near = difflib.get_close_matches(key, signature.parameters, 1)
                    checks.fail(key, "is no argument of this function" + (f"; did you mean {near[0]}?" if near else ""))
            given = signature.bind(*arguments, **keywords).arguments
            values = {}
            for key, value in given.items():
                if key not in options or value is None:
                    continue
                if options[key]["std"] and key not in raw:
                    value, std = parted(key, value)
                    if std is not None:
                        values[options[key]["std"]] = checks.number(f"{key} std", std, 0)
                values[options[key]["key"]] = value if key in raw else plain(key, options[key], value)
            def work(**more):
                return function(**{p.name: given.get(p.name) for p in own}, options={**values, **more})
            answer = work()
            if isinstance(answer, result):
                return answer
            extra = answer[-1] if isinstance(answer[-1], dict) and len(answer) > 3 else {}
            return finish(result, *answer[:3], **extra, **({"_work": work} if "plot" in options else {}))

        called.__signature__ = signature
        lines = [inspect.cleandoc(function.__doc__ or ""), "", "Parameters", "----------"]
        for p in parameters:
            optional = "" if p.default is inspect.Parameter.empty else ", optional"
            lines.append(f"{p.name} : {types(p.name)[0]}{optional}")
            if p.name in options:
                lines += textwrap.wrap(_text_of(options[p.name]), 118, initial_indent="    ", subsequent_indent="    ")
        lines += ["", "Returns", "-------", result.__name__, "    " + (result.__doc__ or "").split("\n")[0]]
        called.__doc__ = "\n".join(lines) + "\n"
        del called.__wrapped__
        return called
    return made


def is_path(value):
    """Whether a value names a file."""
    return isinstance(value, (str, os.PathLike))
