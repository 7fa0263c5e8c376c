# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the extension for Blender, with the wheels that it needs.

    build.py WHEEL... OUT.zip

WHEEL: marching_correctors-*.whl, of the system on which Blender runs; and usd_core-*.whl, for "Write USD".
"""
import re
import sys
import zipfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
# The ends of wheels' tags, and Blender's words for the systems.
PLATFORMS = {"linux.*_x86_64": "linux-x64", "linux.*_aarch64": "linux-arm64", "win_amd64": "windows-x64",
             "win_arm64": "windows-arm64", "macosx.*_arm64": "macos-arm64", "macosx.*_x86_64": "macos-x64"}


def main(*arguments):
    if len(arguments) < 2:
        sys.exit(__doc__)
    wheels, out = [Path(name) for name in arguments[:-1]], Path(arguments[-1])
    platforms = [word for tag, word in PLATFORMS.items() if re.search(tag + r"\.whl$", wheels[0].name)]
    if not wheels[0].is_file() or not platforms:
        sys.exit(f"build.py: {wheels[0]} is no wheel of marching_correctors for a system of Blender's")
    manifest = (FOLDER / "blender_manifest.toml").read_text()
    manifest = manifest.replace("platforms = []", f'platforms = ["{platforms[0]}"]')
    manifest = manifest.replace("wheels = []", "wheels = [" + ", ".join(f'"./wheels/{each.name}"' for each in wheels) + "]")
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        for name in ("__init__.py", "series.py"):
            archive.write(FOLDER / name, name)
        for each in wheels:
            archive.write(each, f"wheels/{each.name}")


if __name__ == "__main__":
    main(*sys.argv[1:])
