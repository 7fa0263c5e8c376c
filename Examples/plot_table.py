# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Plots a column of a table of gauges or fluxes over time, with a line for each gauge or section.

    plot_table.py TABLE.csv COLUMN OUT.png
"""
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

name, column, out = sys.argv[1:]
table = np.atleast_1d(np.genfromtxt(name, delimiter=",", names=True, dtype=None, encoding="utf-8"))
places = table[table.dtype.names[1]]  # of gauges, or sections
for place in dict.fromkeys(places):
    rows = table[places == place]
    plt.plot(rows["time"], rows[column], marker="o", label=place)
plt.xlabel("time")
plt.ylabel(column)
plt.legend()
plt.savefig(out)
