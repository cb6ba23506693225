"""Build backend of `pip install ./apps/python` (PEP 517): CMake builds and installs the package, this makes a wheel of it.

Environment: RIGFIT_BUILD_DIR is a CMake build folder of this source in which the target rigfit_python is built already
(left out: build/python-<version> is configured and built); CMAKE_ARGS are further arguments of the configuration,
CMAKE_BUILD_PARALLEL_LEVEL is the number of compilers at a time (each takes 1 GB of memory and more; default: one a processor).
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def _version():
    return re.search(r"project\(rigfit VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]


def _tag():
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _metadata():
    return (f"Metadata-Version: 2.1\nName: rigfit\nVersion: {_version()}\n"
            "Summary: Parameter identification and test-rig data processing for cables and beams\n"
            "License: GPL-3.0-or-later\nRequires-Python: >=3.9\nRequires-Dist: numpy\n")


def _built():
    """A build folder with the module in it."""
    given = os.environ.get("RIGFIT_BUILD_DIR")
    if given:
        return pathlib.Path(given)
    build = SOURCE / "build" / f"python-{sys.version_info[0]}.{sys.version_info[1]}"
    subprocess.run(["cmake", "-S", SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
                    "-DRIGFIT_BUILD_TESTS=OFF", "-DRIGFIT_BUILD_BENCHMARKS=OFF", "-DRIGFIT_BUILD_PYTHON=ON",
                    f"-DRIGFIT_PYTHON={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
    processes = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(os.cpu_count() or 1)  # make's own default has no limit
    subprocess.run(["cmake", "--build", build, "--target", "rigfit_python", "--parallel", processes], check=True)
    return build


def get_requires_for_build_wheel(config_settings=None):
    """Nothing of an index."""
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the metadata, without which pip would build all to know them, and returns their folder."""
    info = pathlib.Path(metadata_directory) / f"rigfit-{_version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(_metadata())
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel and returns its name."""
    name = f"rigfit-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as prefix:
        subprocess.run(["cmake", "--install", _built(), "--component", "python", "--prefix", prefix], check=True,
                       stdout=sys.stderr)
        found = [f for f in pathlib.Path(prefix).rglob("rigfit/*") if f.is_file()]
        if not any(f.name.startswith("_core.") for f in found):
            raise RuntimeError("the module was not built: it needs pybind11 and Python's headers (Debian: "
                               "python3-pybind11, python3-dev)")
        contents = {f"rigfit/{f.name}": f.read_bytes() for f in found}
    info = f"rigfit-{_version()}.dist-info"
    contents[f"{info}/METADATA"] = _metadata().encode()
    contents[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: rigfit\nRoot-Is-Purelib: false\nTag: {_tag()}\n").encode()
    record = "".join(
        f"{path},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()},{len(data)}\n"
        for path, data in contents.items())
    contents[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in contents.items():
            wheel.writestr(path, data)
    return name
