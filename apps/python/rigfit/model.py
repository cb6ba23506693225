"""Scenes and their FRFs: `Scene`, `frf_of`."""

from collections.abc import Mapping
import pathlib

from . import _core, checks
from .described import call, is_path, verb
from .results import SceneFrfs


class Scene:
    """A rig as a person describes it: nodes, members, loads, sensors. It does not change.

    Parameters
    ----------
    scene : str or path
        TOML text (with a line end), or a scene file.

    Raises
    ------
    InputError
        With file, line, key and remedy.
    """

    def __init__(self, scene):
        if isinstance(scene, str) and "\n" in scene:
            self._core = call(_core.parse_scene, checks.text("scene", scene), "scene")
        elif is_path(scene):
            self._core = call(_core.read_scene, checks.path("scene", scene))
        else:
            checks.fail("scene", f"must be TOML text or a path, not {checks.kind(scene)}")

    @classmethod
    def _of(cls, core):
        scene = cls.__new__(cls)
        scene._core = core
        return scene

    title = property(lambda self: self._core.title, doc="As in the file.")
    nodes = property(lambda self: self._core.nodes(), doc="Names.")
    members = property(lambda self: self._core.members(), doc="Names.")
    loads = property(lambda self: self._core.loads(), doc="Names.")
    sensors = property(lambda self: self._core.sensors(), doc="Names.")
    parameters = property(lambda self: self._core.parameters(),
                          doc="""Every number that can be fitted or set, such as ``"cable.EI"``: name to value.""")

    def with_parameters(self, values):
        """The scene with other values of some parameters, ``{"cable.tension": 210.0}``."""
        if not isinstance(values, Mapping):
            checks.fail("values", f"must be a dict of parameter to value, not {checks.kind(values)}")
        core = self._core
        for name, value in values.items():
            core = call(core.with_parameter, checks.text("values", name), checks.number(f"values[{name!r}]", value))
        return Scene._of(core)

    def to_toml(self):
        """A scene file that reads back to the same scene."""
        return self._core.text()

    def write(self, file):
        """Writes the scene file."""
        pathlib.Path(checks.new_file("file", file)).write_text(self.to_toml())

    def __repr__(self):
        return f"Scene({self.title!r}, members {self.members}, loads {self.loads}, sensors {self.sensors})"


def scene_or_path(scene):
    """As the module takes it: a path, read in the call, or a scene at hand."""
    if isinstance(scene, Scene):
        return scene._core
    if is_path(scene) and "\n" not in str(scene):
        return checks.path("scene", scene)
    return Scene(scene)._core


@verb("frf_of", SceneFrfs, raw={"frequency_hz": "ArrayLike"}, without=("threads", "seed"))
def frf_of(scene, frequency_hz, *, options):
    """FRFs of a scene from its loads to its sensors at lines in Hz, no mode left out: ``H``, complex, shape (lines, sensors, loads),
    in ``units``."""
    lines = checks.array("frequency_hz", frequency_hz)
    if lines.min() < 0:
        checks.fail("frequency_hz", f"must not be negative, not {lines.min():g}")
    *answer, H = call(_core.frf_of, (scene if isinstance(scene, Scene) else Scene(scene))._core, lines, options)
    return *answer, {"frequency_hz": lines, "H": H}
