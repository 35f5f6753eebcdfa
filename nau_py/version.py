"""The version of the package."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("nau_py")
except PackageNotFoundError:  # run from a source tree that was not installed
    __version__ = "0+unknown"
