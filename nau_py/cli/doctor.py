"""``nau-run --doctor``: what this machine has, what it lacks, how to get it."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from nau_py.diagnostics.errors import DeviceError
from nau_py.version import __version__

EXTRAS = {
    "plot": ("matplotlib", "matplotlib", "charts of nau-cost"),
    "exr": ("OpenEXR", "openexr", "EXR pictures"),
    "lua": ("lupa", "lupa", "Lua scripts of projects"),
}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "missing"


def examine() -> int:
    """Print the findings; 0 where projects can run, 1 where something needed is missing."""
    status = 0
    print(f"nau_py      {__version__}, Python {platform.python_version()}, {platform.platform()}")
    try:
        from nau_py.raster.device import get_device

        found = get_device()
        kind = "software" if found.is_software else "hardware"
        print(f"OpenGL      {found.version} on {found.renderer} ({kind})")
    except DeviceError as problem:
        print(f"OpenGL      missing: {problem.diagnostics[0].message}")
        status = 1
    try:
        from nau_py.raytrace.tracing.accelerator import ISA_VARIABLE, embree_isa, embree_version

        isa = f"instruction set {embree_isa()} ({ISA_VARIABLE} chooses another)"
        print(f"Embree      {embree_version()}, embreex {_version('embreex')}, {isa}")
    except DeviceError as problem:
        print(f"Embree      {problem.diagnostics[0].message}")
        status = 1
    except ImportError as problem:
        print(f"Embree      missing: {problem}; pip install embreex")
        status = 1
    print(f"threads     {os.cpu_count() or 1}")
    for name in ("numpy", "moderngl", "PyOpenGL", "assimp-py", "pillow", "lxml", "pydantic"):
        print(f"{name:<11} {_version(name)}")
    for extra, (module, package, purpose) in EXTRAS.items():
        if find_spec(module) is not None:
            print(f"[{extra}]       {package} {_version(package)}: {purpose}")
        else:
            print(f"[{extra}]       not installed ({purpose}): pip install 'nau_py[{extra}]'")
    return status
