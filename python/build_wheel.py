"""Builds libtenon and packs it with the package as a wheel: python3 python/build_wheel.py [FOLDER [LIBRARY]]

With LIBRARY nothing is built: it is packed as it is. The wheel is for this system and any Python 3; it holds the package, the library and nothing else.
"""

import base64
import hashlib
import os
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
LIBRARY = {"win32": "tenon.dll", "darwin": "libtenon.dylib"}.get(sys.platform, "libtenon.so")
VERSION = next(l.split(chr(34))[1] for l in (ROOT / "Cargo.toml").read_text().splitlines() if l.startswith("version"))
METADATA = f"""Metadata-Version: 2.4
Name: tenon
Version: {VERSION}
Summary: Tenon's graphs for free-form timber in Python, over libtenon
License-Expression: MIT OR Apache-2.0
Requires-Python: >=3.9
Requires-Dist: numpy>=1.22
"""


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "wheels")
    if len(sys.argv) > 2:
        library = Path(sys.argv[2])
    else:
        subprocess.run(["cargo", "build", "--release", "--quiet", "-p", "tenon-capi"], cwd=ROOT, check=True)
        library = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / LIBRARY
    tag = f"py3-none-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    info = f"tenon-{VERSION}.dist-info"
    modules = sorted(p for p in (HERE / "tenon").rglob("*") if p.suffix in (".py", ".typed"))
    files = {p.relative_to(HERE).as_posix(): p.read_bytes() for p in modules}
    files[f"tenon/{LIBRARY}"] = library.read_bytes()
    files[f"{info}/METADATA"] = METADATA.encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: build_wheel.py\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    out.mkdir(parents=True, exist_ok=True)
    wheel = out / f"tenon-{VERSION}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            # One date for all, so that the same content makes the same wheel.
            archive.writestr(zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED)
    print(wheel)


main()
