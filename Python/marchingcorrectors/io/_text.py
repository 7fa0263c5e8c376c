# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads numbers that are written as text."""
import warnings

import numpy as np

IS_BLANK = np.isin(np.arange(256), np.frombuffer(b" \t\n\v\f\r", np.uint8))


def parse_numbers(text, kind, count):
    """Returns the first `count` numbers, with blanks between them, of bytes or a memoryview, and where the last one ends.
    Raises ValueError. Time and memory depend only on the numbers that are read, not on the text behind them."""
    size = 16 * count + 64
    while True:  # Longer pieces are tried until one has `count` words.
        piece = bytes(text[:size])
        is_blank = np.append(IS_BLANK[np.frombuffer(piece, np.uint8)], len(piece) == len(text))
        ends = np.flatnonzero(is_blank[1:] & ~is_blank[:-1]) + 1
        if len(ends) >= count or len(piece) == len(text):
            break
        size *= 2
    if len(ends) < count:
        raise ValueError(f"{len(ends)} numbers where there should be {count}")
    end = int(ends[count - 1]) if count else 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # NumPy warns when it stops at a word that is no number.
        values = np.fromstring(piece[:end], kind, sep=" ") if count else np.empty(0, kind)
    if len(values) != count:
        raise ValueError("a word is no number")
    return values, end
