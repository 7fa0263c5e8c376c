# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The core's shared library, its errors and warnings, and the devices that it finds."""
import ctypes
import os
import sys
import threading
import warnings
from pathlib import Path
from typing import List

from . import _structs as c

NO_DEVICE = ("No device was found: this processor has none of the instruction sets of the built-in one, and there "
             "is no OpenCL driver. Install the driver of a GPU.")


class Error(RuntimeError):
    """A call failed; the sentence says what was wrong, with which array or particle, and what to do.

    code: the name of the core's sentence, such as "ISO_OUTSIDE"; "" for one of this package.
    """

    code = property(lambda self: getattr(self.args[0], "code", "") if self.args else "")


class InvalidArgument(Error, ValueError):
    """A parameter is outside its legal range, or a needed array is missing."""


class InvalidData(Error, ValueError):
    """An array holds NaN, an infinite value, or an illegal value."""


class OutOfCapacity(Error, MemoryError):
    """The lattice, the device's memory or the host's would not suffice."""


class DeviceError(Error):
    """No OpenCL device, a program that could not be built, or a device that vanished."""


class Cancelled(Error):
    """The progress callback asked to stop."""


ERRORS = {c.ENUMS["mcor_status"]["MCOR_" + name]: error for name, error in (
    ("INVALID_ARGUMENT", InvalidArgument), ("INVALID_DATA", InvalidData), ("OUT_OF_CAPACITY", OutOfCapacity),
    ("DEVICE_ERROR", DeviceError), ("CANCELLED", Cancelled))}


lib = ctypes.CDLL(str(Path(__file__).with_name("_mcor.dll" if os.name == "nt" else "_mcor.so")))
for _name, (_result, _arguments) in c.FUNCTIONS.items():
    getattr(lib, _name).restype, getattr(lib, _name).argtypes = _result, _arguments
_free = ctypes.CDLL("ucrtbase" if os.name == "nt" else None).free  # This is the C library that the core uses.
_free.restype, _free.argtypes = None, [ctypes.c_void_p]


def take_text(pointer):
    """Returns a text of the core and frees it; "" for NULL."""
    if not pointer:
        return ""
    try:
        return ctypes.string_at(pointer).decode(errors="replace")
    finally:
        _free(pointer)


class Sentence(str):
    """A sentence of the core with Python's words for options. code: its name in mcor_says.def; text: the sentence with slots."""

    code: str
    text: bytes

    def say(self, word):
        """Returns the sentence with other words in its slots. word: a mcor_word."""
        return take_text(lib.mcor_fill_slots(self.text, word, None))


def word_by(function):
    """Makes a mcor_word from function(name, value), which returns "" if it has no word."""
    def write(_, name, value, word, size):
        found = function(name.decode(), value.decode(errors="replace")).encode()[:size - 1]
        ctypes.memmove(word, found + b"\0", len(found) + 1)
        return found != b""

    return c.Word(write)


@word_by
def _python_word(name, value):
    """Returns Python's word: cube_size, dimension=3, precision="double"."""
    known = name in c.OPTIONS or name in c.SLOTS
    if name == "fluid" and value:
        return f"fluid=('{value}', VALUE)"
    value = "True" if name == "estimate_smoothing_length" else value
    return "" if not known else name if not value else f"{name}={value}" if value[0].isdigit() or value == "True" else f'{name}="{value}"'


MEMBERS = {"estimate_smoothing_length": "--smoothing-length estimate",
           **{member: option for option, (_, _, _, member) in c.PROGRAM.items() if member}}


@word_by
def option_word(name, value):
    option = MEMBERS.get(name, "")
    return option and (f"{option} {value}=VALUE" if value and name == "fluid" else f"{option} {value}".strip())


def in_shell(failure):
    """Returns a sentence with the program's words for options."""
    sentence = failure.args[0] if failure.args else ""
    return sentence.say(option_word) if isinstance(sentence, Sentence) else str(failure)


def fill_slots(code, text):
    """Returns a Sentence. text: bytes, with slots such as {cube_size}."""
    sentence = Sentence(take_text(lib.mcor_fill_slots(text, _python_word, None)))
    sentence.code, sentence.text = code, text
    return sentence


def say(code, *values):
    """Returns a Sentence of the core by its name, with these values."""
    text = lib.mcor_says_text(c.ENUMS["mcor_says"]["MCOR_SAYS_" + code])
    return fill_slots(code, (text.decode().replace("%ll", "%") % values).encode(errors="replace"))


def take_sentence(message):
    """Returns a message of the core as a Sentence, "" if there is none, and frees it."""
    if not message.code:
        return ""
    sentence = fill_slots(lib.mcor_says_name(message.code).decode(), message.text) if message.text else say("HOST_MEMORY")
    lib.mcor_free_message(ctypes.byref(message))
    return sentence


_state_lock = threading.Lock()
_ready_in = None  # OpenCL was started in this process.


def start():
    """Prepares OpenCL. Must be called before anything else is asked of it."""
    global _ready_in
    with _state_lock:
        if _ready_in is None:
            _ready_in = os.getpid()
        elif _ready_in != os.getpid():
            raise DeviceError("OpenCL was started before this process was forked, and drivers do not survive "
                              'that: use the "spawn" method of multiprocessing, or do not call this package '
                              "before the fork.")


def _list():
    text = ctypes.c_void_p()
    lib.mcor_list_devices(ctypes.byref(text))
    return take_text(text.value)


def devices() -> List[str]:
    """The devices, "device (platform)" each, in the order of their numbers: the built-in one, whose kernels
    are in this package, then those of OpenCL drivers, as the system's loader lists them.
    """
    start()
    return [line.partition(": ")[2] for line in _list().splitlines()]


class InputWarning(UserWarning):
    """Something about the particles or options is legal, but hardly what was meant.

    code: the name of the core's sentence, such as "ISO_OUTSIDE"; "" for one of this package.
    """

    code = Error.code


def warn(sentence):
    """Warns at the caller's line, the first one outside of this package."""
    level, frame = 1, sys._getframe(0)
    while frame is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, InputWarning, stacklevel=level)


def describe_warnings(arguments, surface):
    """Returns {number: sentence} of what the core finds strange in a surface's input."""
    found = {}
    for number in range(c.ENUMS["mcor_warning"]["MCOR_WARNING_COUNT"]):
        sentence = take_sentence(lib.mcor_describe_warning(
            number, ctypes.byref(arguments.input), ctypes.byref(arguments.options), ctypes.byref(surface)))
        if sentence:
            found[number] = sentence
    return found


def warn_of_particles(arguments, statistics):
    """Gives the warnings that do not need a surface."""
    kinds, found = c.ENUMS["mcor_warning"], describe_warnings(arguments, c.mcor_surface(statistics=statistics))
    for kind in ("MCOR_WARN_FAR", "MCOR_WARN_PERIOD", "MCOR_WARN_COARSE"):
        if kinds[kind] in found:
            warn(found[kinds[kind]])
