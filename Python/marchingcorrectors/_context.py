# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Contexts: devices with their compiled programs, and the data that they keep between calls."""
from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
import threading
from typing import Union

import numpy as np

from . import _structs as c
from ._library import ERRORS, NO_DEVICE, DeviceError, Error, InvalidArgument, _list, lib, start, take_sentence


class Context:
    """A device, its compiled programs, and what is kept on it between calls.

    Example: with Context() as context: isosurface(x, speed, 1.0, smoothing_length=h, context=context, particles_version=1)

    device: a number or part of a name as in `devices()`; None: the built-in
    device if it can do the run. Calls on one context from several threads wait for each other; contexts of their own run side by side.

    Particles that stay the same between calls can stay on the device: give them equal nonzero
    numbers as `particles_version` (and `scalar_version`).
    """

    def __init__(self, device: Union[None, str, int] = None) -> None:
        self._pid = os.getpid()
        self._lock = threading.Lock()
        self._used_by = None  # This is the thread that holds the lock.
        self._handle = ctypes.c_void_p()
        self._wanted = "" if device is None else str(device)
        start()
        if not _list():
            raise DeviceError(NO_DEVICE)
        status = lib.mcor_create_context(self._wanted.encode(errors="replace"), ctypes.byref(self._handle))
        if status:
            sentence = self._sentence()
            self.close()
            raise ERRORS.get(status, Error)(sentence)

    @contextlib.contextmanager
    def _alone(self):
        """Waits for other threads' calls. Refuses a callback of the present call, which would wait for ever."""
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
        # A forked child has the handle, but not the driver's threads.
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
    """Shows progress if there is no tqdm: by one line on stderr, which is overwritten; in a file, by a line per
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
    """The callback between launches. In the main thread it also sees Ctrl-C: Python's own handler would raise where nobody
    can catch the exception, so a handler of ours only notes the signal."""

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
