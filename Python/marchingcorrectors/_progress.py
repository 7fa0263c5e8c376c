# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a callback from the value of progress=: a function of the caller, or True for a bar."""
import contextlib
import sys

from ._library import InvalidArgument


class TextBar:
    """The bar if there is no tqdm: one line on stderr, which is overwritten; in a file, a line per phase."""

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
