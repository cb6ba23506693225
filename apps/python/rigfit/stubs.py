"""Writes the types of the package, for editors and mypy: ``python -m rigfit.stubs FILE``."""

import inspect
import pathlib
import sys

import rigfit
from rigfit import _core
from rigfit.results import NAMED, Result

_HEAD = """from collections.abc import Iterator, Mapping, Sequence
import os
from typing import Any, Literal

from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | os.PathLike[str]
_Value = float | tuple[float, float] | Estimate
_Source = _Path | Recording | Mapping[str, ArrayLike] | Sequence[Mapping[str, Any] | Channel]
_Sources = _Source | Sequence[_Source]
_SceneLike = Scene | _Path

"""


def _signature(function, bound=False):
    parameters, star = [], False
    for i, p in enumerate(inspect.signature(function).parameters.values()):
        if p.kind is p.KEYWORD_ONLY and not star:
            parameters.append("*")
        star |= p.kind in (p.KEYWORD_ONLY, p.VAR_POSITIONAL)
        name = {p.VAR_KEYWORD: "**", p.VAR_POSITIONAL: "*"}.get(p.kind, "") + p.name
        kind = "Any" if p.annotation is p.empty else p.annotation if isinstance(p.annotation, str) else p.annotation.__name__
        default = "" if p.default is p.empty else " = ..."
        parameters.append(name if bound and i == 0 else f"{name}: {kind}{default}")
    returns = inspect.signature(function).return_annotation
    returns = "None" if function.__name__ == "__init__" else "Any" if returns is inspect.Signature.empty else returns
    return f"({', '.join(parameters)}) -> {returns}: ..."


def _type(schema):
    """The type of what a key of a result gives (results.wrapped)."""
    if "anyOf" in schema:
        kinds = " | ".join(_type(one) for one in schema["anyOf"]).split(" | ")
        return " | ".join(dict.fromkeys(kinds))  # a number may be null anyway
    kind, keys = schema.get("type", "Any"), set(schema.get("properties", ()))
    if isinstance(kind, list):
        return "float | None"
    if kind == "array":
        items = schema.get("items", {})
        return "Records" if items.get("type") == "object" else f"list[{_type(items)}]"
    if kind == "object":
        return "Estimate" if {"value", "std"} <= keys and not NAMED & keys else "Record"
    return {"string": "str", "integer": "int", "boolean": "bool", "null": "None", "number": "float"}.get(kind, "Any")


def _keys(kind):
    """Types of a class: of a verb's result, what its schema has, and what is no key of the document."""
    verb = kind.__name__.removesuffix("Result").lower()
    keys = {}
    if issubclass(kind, Result) and verb not in ("", kind.__name__.lower()):
        schema = _core.schema(verb)
        for one in schema.get("anyOf", [schema]):
            keys |= {key: _type(of) for key, of in one["properties"].items()}
    return keys | kind.__dict__.get("__annotations__", {})


def _class(kind):
    bases = [base.__name__ for base in kind.__bases__ if base.__module__.startswith("rigfit") or base.__module__ == "builtins"]
    bases = [base for base in bases if base not in ("object", "pybind11_object")]
    lines = [f"class {kind.__name__}{'(' + ', '.join(bases) + ')' if bases else ''}:"]
    for name, kind_of in _keys(kind).items():
        lines.append(f"    {name}: {kind_of if isinstance(kind_of, str) else kind_of.__name__}")
    for name, member in vars(kind).items():
        if isinstance(member, property):
            returns = getattr(member.fget, "__annotations__", {}).get("return", "Any")
            lines += ["    @property", f"    def {name}(self) -> {returns}: ..."]
        elif inspect.isfunction(member) and (not name.startswith("_") or name in ("__init__", "__getattr__", "__getitem__", "__len__",
                                                                                 "__iter__", "__float__")):
            lines.append(f"    def {name}{_signature(member, bound=True)}")
    return "\n".join(lines if len(lines) > 1 else [lines[0] + " ..."])


def text():
    """The stub file."""
    parts = [f"def {name}{_signature(getattr(rigfit, name))}" if inspect.isfunction(getattr(rigfit, name)) else
             _class(getattr(rigfit, name)) for name in rigfit.__all__]
    return _HEAD + "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    pathlib.Path(sys.argv[1]).write_text(text())
