# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Output files by the rules of the program marching-correctors: written beside their places, then all take them."""
import os
import shutil
import stat
import tempfile

from ._particles import FileError

STEP_MARK = b"<!-- a step of a film by marching-correctors -->"


def _identity(path):
    """Equal for all names of one file; a file that does not exist yet is named by its folder and its name there."""
    try:
        status = os.stat(path)
        return status.st_dev, status.st_ino
    except FileNotFoundError:
        folder, name = os.path.split(os.path.realpath(path))
        status = os.stat(folder)
        return status.st_dev, status.st_ino, name


class Outputs:
    """Replaces all files at the end of the with block, or none if it raises.

    Checks first that no output is an input or another output, by whatever link. A symbolic link is followed, and the
    file behind it replaced, with its mode; other hard links of that file keep what was in it. steps: outputs whose
    names nobody gave; they replace nothing but steps of an older film.
    """

    def __init__(self, inputs, outputs, steps=()):
        self._written, self._folders = [], []
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
                raise FileError(f"{path} already exists and is not a step of a film; choose another name for the "
                                "film, or remove the file.")

    def write(self, path, data):
        """Bytes; no more than one file of them is in memory."""
        with _sentences(path):
            target = os.path.realpath(path)
            if os.path.exists(target) and not stat.S_ISREG(os.stat(target).st_mode):
                self._written.append((None, target, data))  # a device or a pipe
                return
            old = None
            if os.path.exists(target):
                with open(target, "r+b"):  # asks the system, which may forbid it
                    old = os.stat(target)
                    mode = stat.S_IMODE(old.st_mode)
            else:
                mask = os.umask(0)
                os.umask(mask)
                mode = 0o666 & ~mask
            folder, name = os.path.split(target)
            descriptor, beside = tempfile.mkstemp(dir=folder, prefix=f".{name[:50]}.")
            self._written.append((beside, target, b""))
            with os.fdopen(descriptor, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(descriptor)
            if old and hasattr(os, "chown"):
                try:
                    os.chown(beside, old.st_uid, old.st_gid)
                except OSError:
                    mode &= 0o707  # another group must not gain what the old one was allowed
            os.chmod(beside, mode)

    def beside(self, path):
        """Where a library is to write that file: in a folder of its own beside the place, under its name."""
        with _sentences(path):
            target = os.path.realpath(path)
            if os.path.exists(target) and not os.path.isfile(target):
                return str(path)
            if os.path.exists(target):
                with open(target, "r+b"):
                    pass
            folder, name = os.path.dirname(target), os.path.basename(path)
            self._folders.append(tempfile.mkdtemp(dir=folder, prefix=f".{name[:50]}."))
            self._written.append((os.path.join(self._folders[-1], name), target, b""))
            return self._written[-1][0]

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        try:
            while kind is None and self._written:
                beside, target, data = self._written[0]
                with _sentences(target):
                    if beside:
                        if os.path.dirname(beside) in self._folders and os.path.exists(target):
                            shutil.copymode(target, beside)
                        os.replace(beside, target)
                    else:
                        with open(target, "wb") as file:
                            file.write(data)
                self._written.pop(0)
        finally:
            for beside, _, _ in self._written:
                if beside and os.path.exists(beside):
                    os.unlink(beside)
            for folder in self._folders:
                shutil.rmtree(folder, ignore_errors=True)


class _sentences:
    """What the system says of a file, with the file's name."""

    def __init__(self, path):
        self._path = path

    def __enter__(self):
        pass

    def __exit__(self, kind, error, _):
        if isinstance(error, OSError):
            raise FileError(f"{self._path} could not be written: {error.strerror}.") from None


def _is_step(path):
    try:
        with open(path, "rb") as file:
            return STEP_MARK in file.read(256)
    except OSError:
        return False
