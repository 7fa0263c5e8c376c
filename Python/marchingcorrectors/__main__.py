# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""python -m marchingcorrectors COMMAND IN... OUT [--help]. The commands:

convert                      to .vtp or .pvd: a solver's files for ParaView and the shell program; to .usdc: surfaces for Blender and Houdini
surface                      to .usdc: a film; else the surface of one file; takes the shell program's options
gauge, slice, line           levels, and the field on a plane or a line; take the shell program's options

Several files are the times of a .pvd, and of a film (.usdc, .usda, .usd); else they are bodies of one set (.vtp, .vtu, .vtk)."""
import signal
import sys
import warnings

from ._command import COMMANDS, run
from ._film import run_convert
from ._library import Error, in_shell


def main(arguments):
    if arguments[:1] in (["-h"], ["--help"]):
        print(__doc__.strip())
        return 0
    if not arguments or arguments[0] not in ("convert", *COMMANDS):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    for name in ("SIGTERM", "SIGHUP"):  # If the process is ended like this, it leaves no file behind.
        number = getattr(signal, name, None)
        if number and signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, lambda number, _: sys.exit(128 + number))
    warnings.showwarning = lambda warning, *_: print(f"marchingcorrectors: warning: {in_shell(warning)}", file=sys.stderr)
    try:
        if arguments[0] == "convert":
            run_convert(arguments[1:])
        else:
            run(arguments)
    except ImportError as error:
        print(f'marchingcorrectors: this needs the package {error.name}: pip install {error.name}',
              file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    except (Error, OSError) as error:
        print(f"marchingcorrectors: {in_shell(error)}", file=sys.stderr)
        return 1
    except MemoryError:
        print("marchingcorrectors: memory ran out", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
