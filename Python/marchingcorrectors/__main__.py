# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""python -m marchingcorrectors convert IN... OUT.vtp|OUT.pvd: a solver's files for ParaView and the shell program.

Several files become the times of a .pvd; in a .vtp they are bodies of one set (.vtp, .vtu, .vtk)."""
import sys

from ._library import Error
from .io import FileError


def main(arguments):
    if len(arguments) < 3 or arguments[0] != "convert":
        print(__doc__.strip(), file=sys.stderr)
        return 2
    try:
        from .io.convert import convert

        convert(arguments[1:-1], arguments[-1])
    except ImportError as error:
        print(f'marchingcorrectors: this needs the package {error.name}: pip install "marching-correctors[files,vtk]"',
              file=sys.stderr)
        return 1
    except (Error, FileError, OSError) as error:
        print(f"marchingcorrectors: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
