"""What goes wrong: one family of exceptions, with the codes of the program's JSON documents."""


class Error(Exception):
    """Base of all exceptions of this package.

    Attributes
    ----------
    code : str
        Stable, for programs: ``"bad_input"``, ``"wrong_usage"``, ``"argument"``, ``"not_converged"``, ``"fault"``, or of
        a refusal the code of its finding, such as ``"no_hit_accepted"``: ``error.code`` of the program's JSON document.
    message : str
        For a person.
    argument : str
        The argument that is wrong; empty: none alone.
    file, channel, key, value : str
        Where in the input; empty: not tied to one.
    line, column : int
        From 1; 0: not tied to one.
    problem, remedy : str
        What is wrong without the place, and what to do about it.
    where : str
        File, channel, mode of a refusal.
    result : Result or None
        What can be had all the same.
    exit_code : int
        With which the program would end.
    """

    code = "fault"
    exit_code = 1
    argument = file = channel = key = value = remedy = where = ""
    line = column = 0
    result = None

    def __init__(self, message, **fields):
        super().__init__(message)
        self.message = self.problem = message
        self.__dict__.update(fields)


class ArgumentError(Error, ValueError, TypeError):
    """An argument of a wrong type, shape or value; ``argument`` names it."""

    code = "argument"
    exit_code = 2


class UsageError(Error, ValueError):
    """Arguments that contradict each other or leave something open."""

    code = "wrong_usage"
    exit_code = 2


class InputError(Error):
    """An input cannot be read; file, line, channel, value and remedy say where and what to do."""

    code = "bad_input"
    exit_code = 3


class Refused(Error):
    """The data cannot support what was asked; ``result`` is what can be had."""

    code = "refused"
    exit_code = 4


class NotConverged(Error):
    """The computation did not converge; ``result`` is how far it came."""

    code = "not_converged"
    exit_code = 5


class InternalError(Error):
    """A fault of rigfit."""


class DataWarning(UserWarning):
    """A warning about data or result; all of them are in ``result.warnings`` too."""
