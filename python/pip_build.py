"""Builds the wheel of `pip install .` with CMake; the standard library is all it needs (PEP 517).
CMAKE_ARGS in the environment are further arguments of CMake."""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]


def _version():
    return re.search(r"project\(delio VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


def _texts():
    """Files that describe the wheel."""
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{tag}-{tag}-{platform}", {
        "METADATA": f"Metadata-Version: 2.1\nName: delio\nVersion: {_version()}\n"
                    "Summary: LiDAR odometry and mapping on MRPT\nLicense: BSD-3-Clause\n"
                    "Requires-Python: >=3.9\nRequires-Dist: numpy\n",
        "WHEEL": f"Wheel-Version: 1.0\nGenerator: delio\nRoot-Is-Purelib: false\nTag: {tag}-{tag}-{platform}\n",
    }


def _build(prefix):
    """Builds the module and installs the package into a folder."""
    build = ROOT / "build" / "pip"
    off = ["TESTS", "RAWLOG_TOOLS", "GUI"]
    subprocess.run(["cmake", "-S", ROOT, "-B", build, "-DDELIO_BUILD_PYTHON=ON", "-DDELIO_PYTHON_DIR=.",
                    f"-DPython_EXECUTABLE={sys.executable}", "-DDELIO_INSTALL_DOCUMENTS=OFF",
                    *[f"-DDELIO_BUILD_{name}=OFF" for name in off], *os.environ.get("CMAKE_ARGS", "").split()], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "_delio", "-j", str(os.cpu_count())], check=True)
    subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", prefix], check=True)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """What pip calls; returns the name of the wheel."""
    tag, texts = _texts()
    info = f"delio-{_version()}.dist-info"
    name = f"delio-{_version()}-{tag}.whl"
    with tempfile.TemporaryDirectory() as folder:
        _build(folder)
        files = {path.relative_to(folder).as_posix(): path.read_bytes()
                 for path in sorted(pathlib.Path(folder).rglob("*")) if path.is_file()}
    files.update({f"{info}/{file}": text.encode() for file, text in texts.items()})
    record = ""
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for file, data in files.items():
            wheel.writestr(file, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")
            record += f"{file},sha256={digest},{len(data)}\n"
        wheel.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")
    return name
