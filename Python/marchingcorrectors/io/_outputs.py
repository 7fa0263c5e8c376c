# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes output files by the program's rules: each beside its target; at the end, all of them replace their targets."""
import contextlib
import os
import secrets
import shutil
import stat

from .._library import say
from ._particles import FileError

STEP_MARK = b"<!-- a step of a film by marching-correctors -->"


def _identity(path):
    """Returns an identity that is the same for all names of one file. A file that does not exist yet is identified by its folder and its name."""
    try:
        status = os.stat(path)
        return status.st_dev, status.st_ino
    except FileNotFoundError:
        folder, name = os.path.split(os.path.realpath(path))
        status = os.stat(folder)
        return status.st_dev, status.st_ino, name


class Outputs:
    """Replaces all files at the end of the with block, or none if it raises.

    Checks first that no output is an input or another output, by whatever link. If an output is a symbolic link, the file
    behind it is replaced, and its mode stays; other hard links of that file keep the old contents. steps: outputs that the user
    has not named; they replace only steps of an older film.
    """

    def __init__(self, inputs, outputs, steps=()):
        self._written = []  # Each entry is (where the file is, where it goes).
        read = {_identity(path) for path in inputs if os.path.exists(path)}
        found = set()
        for path in (*outputs, *steps):
            with _sentences(path):
                identity = _identity(path)
            if os.path.isdir(path):
                raise FileError(f"{path} could not be written: it is a directory.")
            if identity in read:
                raise FileError(f"{path} would overwrite the input; choose another name for the output.")
            if identity in found:
                raise FileError(f"{path} would be written twice; choose another name for the output.")
            found.add(identity)
        for path in steps:
            if os.path.lexists(path) and not _is_step(path):
                raise FileError(say("FILM_STEP_TAKEN", path))

    def write(self, path, data):
        """Writes one file; its bytes need not stay in memory."""
        with _sentences(path), open(self.beside(path), "wb") as file:
            file.write(data)
            file.flush()
            if os.path.isfile(file.name):
                os.fsync(file.fileno())

    def beside(self, path):
        """Returns the path to write to: in a new folder beside the target, with its name; for a device or a pipe, the target itself."""
        with _sentences(path):
            target = os.path.realpath(path)
            if os.path.exists(target):
                if not os.path.isfile(target):
                    return str(path)
                with open(target, "r+b"):  # This asks the system, which may forbid it.
                    pass
            folder, name = os.path.dirname(target), os.path.basename(path)
            own = os.path.join(folder, f".{name[:50]}.{secrets.token_hex(4)}")
            self._written.append((os.path.join(own, name), target))  # This comes first, because a signal may end the program anywhere.
            os.mkdir(own, 0o700)
            return self._written[-1][0]

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        try:
            for beside, target in self._written if kind is None else ():
                with _sentences(target):
                    if os.path.exists(target):
                        _copy_mode(target, beside)
                    os.replace(beside, target)
        finally:
            self._clear()

    def _clear(self):
        try:
            while self._written:
                shutil.rmtree(os.path.dirname(self._written[-1][0]), ignore_errors=True)
                self._written.pop()
        finally:
            if self._written:  # A signal came.
                self._clear()


def _copy_mode(old, new):
    """Copies the mode, and owner and group if that is allowed."""
    status = os.stat(old)
    mode = stat.S_IMODE(status.st_mode)
    if hasattr(os, "chown"):
        try:
            os.chown(new, status.st_uid, status.st_gid)
        except OSError:
            mode &= 0o707  # Another group must not gain what the old one was allowed.
    os.chmod(new, mode)


@contextlib.contextmanager
def _sentences(path):
    """Turns the system's errors into sentences with the file's name."""
    try:
        yield
    except OSError as error:
        raise FileError(f"{path} could not be written: {error.strerror}.") from None


def _is_step(path):
    try:
        with open(path, "rb") as file:
            return STEP_MARK in file.read(256)
    except OSError:
        return False
