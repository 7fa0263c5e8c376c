# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a function of the values of progress=: a function of the caller, or True for a bar."""
import contextlib
import sys

from ._library import InvalidArgument


class TextBar:
    """Is the bar without tqdm: one line on stderr that is overwritten, or a line per phase in a file."""

    def __init__(self):
        self.phase, self.percent = "", -1

    def __call__(self, fraction, phase):
        percent, line_by_line = int(100 * fraction), not sys.stderr.isatty()
        if phase != self.phase or not line_by_line and percent != self.percent:
            self.phase, self.percent = phase, percent
            sys.stderr.write(f"{'' if line_by_line else chr(13)}{percent:3d} % {phase:<20}"
                             f"{chr(10) if line_by_line else ''}")
            sys.stderr.flush()

    def close(self):
        if sys.stderr.isatty() and self.percent >= 0:
            sys.stderr.write("\n")


class TqdmBar:
    def __init__(self, tqdm):
        self.bar = tqdm(total=100, unit="%", leave=True, bar_format="{l_bar}{bar}| {elapsed}")

    def __call__(self, fraction, phase):
        self.bar.set_description_str(phase, refresh=False)
        self.bar.update(int(100 * fraction) - self.bar.n)

    def close(self):
        self.bar.close()


@contextlib.contextmanager
def callback_of(progress):
    """Returns the function to call with a fraction and a phase, or None."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        try:
            from tqdm import tqdm

            bar = TqdmBar(tqdm)
        except ImportError:
            bar = TextBar()
        try:
            yield bar
        finally:
            bar.close()
    elif callable(progress):
        yield progress
    else:
        raise InvalidArgument(f"progress is {progress!r}; it must be True, for a bar, or a function that takes a "
                              "fraction from 0 to 1 and the name of the phase.")
