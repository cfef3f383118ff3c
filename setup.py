"""Builds umtet._core by CMake, in build/release or in the folder UMTET_BUILD; pyproject.toml has the rest."""
import os
import re
import shutil
import subprocess
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
VERSION = re.search(r"project\(umtet VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


class ByCMake(build_ext):
    """What a build folder has is not built again."""

    def build_extension(self, ext):
        folder = Path(os.environ.get("UMTET_BUILD", ROOT / "build" / "release"))
        if not (folder / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "--preset", "release", "-B", folder], cwd=ROOT, check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "umtet_python"], check=True)
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(next((folder / "python" / "umtet").glob("_core.*.so")), target)


setup(version=VERSION, ext_modules=[Extension("umtet._core", [])], cmdclass={"build_ext": ByCMake})
