# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The core's shared library, its errors and warnings, and contexts: devices with their compiled programs, and the data that they keep between
calls."""
from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
import threading
import warnings
from pathlib import Path
from typing import List, Union

import numpy as np

from . import _structs as c

NO_DEVICE = ("No device was found: this processor has none of the instruction sets of the built-in one, and there "
             "is no OpenCL driver. Install the driver of a GPU.")


class Error(RuntimeError):
    """A call failed; the sentence says what was wrong, with which array or particle, and what to do.

    code: the name of the core's sentence, such as "ISO_OUTSIDE"; "" for a sentence of this package.
    """

    code = property(lambda self: getattr(self.args[0], "code", "") if self.args else "")


class InvalidArgument(Error, ValueError):
    """A parameter is outside its legal range, or a needed array is missing."""


class InvalidData(Error, ValueError):
    """An array holds NaN, an infinite value, or an illegal value."""


class OutOfCapacity(Error, MemoryError):
    """The lattice would be too large, or the memory of the device or of the host would not suffice."""


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
        """Returns the sentence with an interface's own words for its options. word: what word_by() returns."""
        return take_text(lib.mcor_fill_slots(self.text, word, None))


def word_by(function):
    """Makes a C callback of type mcor_word from a Python function. function(name, value) returns the words for an option with this
    value, or "" if it knows none."""
    def write(_, name, value, word, size):
        found = function(name.decode(), value.decode(errors="replace")).encode()[:size - 1]
        ctypes.memmove(word, found + b"\0", len(found) + 1)
        return found != b""

    return c.Word(write)


@word_by
def _python_word(name, value):
    """Returns Python's words for an option and its value, such as cube_size, dimension=3 or precision="double"; "" for a name that Python lacks."""
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
    """Returns the sentence of an exception, with the program's words for options."""
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
    """Returns a message of the core as a Sentence, or "" if the message is empty. Frees the message."""
    if not message.code:
        return ""
    sentence = fill_slots(lib.mcor_says_name(message.code).decode(), message.text) if message.text else say("HOST_MEMORY")
    lib.mcor_free_message(ctypes.byref(message))
    return sentence


_started = {}  # {"in": the number of the process that has started OpenCL}


def start():
    """Must be called before each use of OpenCL. Raises DeviceError if OpenCL was started before this process was forked."""
    if _started.setdefault("in", os.getpid()) != os.getpid():
        raise DeviceError("OpenCL was started before this process was forked, and drivers do not survive that: use the \"spawn\" "
                          "method of multiprocessing, or do not call this package before the fork.")


def devices() -> List[str]:
    """Returns the devices, each as "device (platform)", in the order of their numbers: first the built-in one, whose kernels
    are in this package, then the devices of OpenCL drivers, in the order of the system's loader.
    """
    start()
    text = ctypes.c_void_p()
    lib.mcor_list_devices(ctypes.byref(text))
    return [line.partition(": ")[2] for line in take_text(text.value).splitlines()]


class InputWarning(UserWarning):
    """Something about the particles or options is legal, but probably a mistake.

    code: the name of the core's sentence, such as "ISO_OUTSIDE"; "" for a sentence of this package.
    """

    code = Error.code


def warn(sentence):
    """Warns, unless the sentence is empty, at the caller's line: the first one outside of this package."""
    if not sentence:
        return
    level, frame = 1, sys._getframe(0)
    while frame is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, InputWarning, stacklevel=level)


def describe_warnings(arguments, surface):
    """Returns {number: sentence} of what the core finds strange in a surface's input."""
    given = [ctypes.byref(each) for each in (arguments.input, arguments.options, surface)]
    found = [take_sentence(lib.mcor_describe_warning(i, *given)) for i in range(c.ENUMS["mcor_warning"]["MCOR_WARNING_COUNT"])]
    return {i: sentence for i, sentence in enumerate(found) if sentence}


def warn_of_particles(arguments, statistics):
    """Warns of particles far away, of a period that is too short, and of rounded positions. Needs no surface."""
    kinds, found = c.ENUMS["mcor_warning"], describe_warnings(arguments, c.mcor_surface(statistics=statistics))
    for kind in ("MCOR_WARN_FAR", "MCOR_WARN_PERIOD", "MCOR_WARN_COARSE"):
        if kinds[kind] in found:
            warn(found[kinds[kind]])


# -- contexts --

class Context:
    """A device, its compiled programs, and what is kept on it between calls.

    Example: with Context() as context: isosurface(x, speed, 1.0, smoothing_length=h, context=context, particles_version=1)

    device: a number or part of a name as in `devices()`; None: the built-in
    device if it can do the run. Calls on one context from several threads wait for each other; calls on several contexts run side by side.

    Particles that stay the same between calls can stay on the device: give them equal nonzero
    numbers as `particles_version` (and `scalar_version`).
    """

    def __init__(self, device: Union[None, str, int] = None) -> None:
        self._pid = os.getpid()
        self._lock = threading.Lock()
        self._used_by = None  # This is the thread that holds the lock.
        self._handle = ctypes.c_void_p()
        self._wanted = "" if device is None else str(device)
        if not devices():
            raise DeviceError(NO_DEVICE)
        status = lib.mcor_create_context(self._wanted.encode(errors="replace"), ctypes.byref(self._handle))
        if status:
            sentence = self._sentence()
            self.close()
            raise ERRORS.get(status, Error)(sentence)

    @contextlib.contextmanager
    def _alone(self):
        """Waits until no other thread uses the context. Raises InvalidArgument if a callback of the running call wants to use the
        context, because the callback would wait for ever."""
        if self._used_by == threading.get_ident():
            raise InvalidArgument("A progress callback cannot use the context whose call it belongs to. Use "
                                  "another Context there, or do it when the call has returned.")
        with self._lock:
            self._used_by = threading.get_ident()
            try:
                yield
            finally:
                self._used_by = None

    def _sentence(self):
        return take_sentence(lib.mcor_last_message(self._handle))

    def release_memory(self) -> None:
        """Drops what is kept on the device between calls; compiled programs stay."""
        with self._alone():
            if self._handle:
                lib.mcor_release_memory(self._handle)

    def close(self) -> None:
        """Releases the device. Using the context afterwards is an error."""
        # A forked child has the handle, but not the driver's threads, so it cannot free the context.
        if self._handle and self._pid == os.getpid():
            with self._alone():
                lib.mcor_free_context(self._handle)
        self._handle = ctypes.c_void_p()

    def __repr__(self) -> str:
        return f"<Context: {'closed' if not self._handle else self._wanted or 'the device that is found first'}>"

    def __enter__(self) -> Context:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self):
        """Refuses pickle and copy: two contexts would both release the device."""
        raise TypeError("A Context cannot be copied or pickled: make another one for the same device.")

    def __del__(self):
        if getattr(self, "_handle", None):
            self.close()

    def run(self, call, options, progress):
        """Runs call(handle) while no other thread uses the context. Raises the core's error, the callback's exception, or
        KeyboardInterrupt."""
        start()
        with self._alone(), callback_of(progress) as callback, Watch(callback) as watch:
            if not self._handle:
                raise DeviceError("This context was closed; make another one.")
            options.progress = watch.callback
            try:
                status = call(self._handle)
            finally:
                options.progress = c.Progress()
            error = ERRORS.get(status, Error)(self._sentence()) if status else None
        if watch.failure is not None:
            raise watch.failure
        if watch.interrupted:
            watch.before(*watch.interrupted)
            raise KeyboardInterrupt  # The user's handler raised nothing, but the run has ended.
        if error:
            raise error


class TextBar:
    """Shows progress on stderr if there is no tqdm: on a screen as one line that is overwritten, in a file as a line for each
    phase."""

    def __init__(self):
        self.state = None

    def __call__(self, fraction, phase):
        is_screen, percent = sys.stderr.isatty(), int(100 * fraction)
        state = (phase, percent) if is_screen else phase
        if state != self.state:
            self.state = state
            print(f"{chr(13) * is_screen}{percent:3d} % {phase:<20}", end="" if is_screen else "\n", file=sys.stderr, flush=True)

    def close(self):
        if sys.stderr.isatty() and self.state:
            print(file=sys.stderr)


@contextlib.contextmanager
def callback_of(progress):
    """Yields the function to call with a fraction and a phase, or None."""
    if progress is not True and progress not in (None, False) and not callable(progress):
        raise InvalidArgument(f"progress is {progress!r}; it must be True, for a bar, or a function that takes a "
                              "fraction from 0 to 1 and the name of the phase.")
    if progress is not True:
        yield progress or None
        return
    try:
        from tqdm import tqdm
    except ImportError:
        bar = call = TextBar()
    else:
        bar = tqdm(total=100, unit="%", leave=True, bar_format="{l_bar}{bar}| {elapsed}")

        def call(fraction, phase):
            bar.set_description_str(phase, refresh=False)
            bar.update(int(100 * fraction) - bar.n)
    with contextlib.closing(bar):
        yield call


class Watch:
    """The callback that the core calls between launches. In the main thread, it also ends the run at Ctrl-C: a handler notes
    the signal, because Python's own handler would raise inside the core's call, where nobody can catch the exception."""

    def __init__(self, progress):
        self.progress, self.failure, self.interrupted, self.before = progress, None, None, None
        self.callback = c.Progress(self.report)

    def __enter__(self):
        if threading.current_thread() is threading.main_thread():
            self.before = signal.getsignal(signal.SIGINT)
            if callable(self.before):
                signal.signal(signal.SIGINT, self.note)
        return self

    def __exit__(self, *_):
        if callable(self.before):
            signal.signal(signal.SIGINT, self.before)

    def note(self, number, frame):
        self.interrupted = (number, frame)

    def report(self, _, fraction, phase):
        if self.interrupted:
            return 1
        if self.progress is None:
            return 0
        try:
            answer = self.progress(fraction, phase.decode())
            return int(answer is False or isinstance(answer, np.bool_) and not answer)
        except BaseException as failure:  # The exception is raised again where the call returns.
            self.failure = failure
            return 1


_contexts = {}
_contexts_lock = threading.Lock()


def default_context(device):
    """Returns a context for this device. Between calls, it keeps only the compiled programs."""
    start()
    key = "" if device is None else str(device)
    with _contexts_lock:
        if key not in _contexts:
            _contexts[key] = Context(device)
        return _contexts[key]
