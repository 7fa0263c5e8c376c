# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tables as Markdown, aligned so that they read well on a terminal too; the machine in words."""
import os
import pathlib
import platform


class Report:
    """Text that grows; every line is printed at once, as a whole benchmark takes long."""

    def __init__(self):
        self.lines = []

    def text(self, line=""):
        self.lines.append(line)
        print(line, flush=True)

    def heading(self, line):
        self.text()
        self.text(f"## {line}")
        self.text()

    def table(self, header, rows):
        """First column to the left, all others to the right."""
        rows = [[str(cell) for cell in row] for row in rows]
        widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]

        def line(cells):
            left, *right = cells
            fields = [left.ljust(widths[0])]
            fields += [cell.rjust(width) for cell, width in zip(right, widths[1:])]
            return "| " + " | ".join(fields) + " |"

        self.text(line(header))
        rules = ["-" * widths[0]] + ["-" * (width - 1) + ":" for width in widths[1:]]
        self.text("| " + " | ".join(rules) + " |")
        for row in rows:
            self.text(line(row))
        self.text()


def mebibytes(size):
    return f"{size / 2 ** 20:,.0f} MiB"


def seconds(value):
    """Three digits that count."""
    return f"{value:.1f}" if value >= 100 else f"{value:.2f}" if value >= 10 else f"{value:.3f}"


def ratio(value):
    size = abs(value)
    return f"{value:.0f}" if size >= 100 else f"{value:.1f}" if size >= 10 else \
        f"{value:.2f}" if size >= 0.1 else f"{value:.2g}"


def machine():
    """Processor, cores, memory and system, as Linux tells them."""
    model = platform.processor()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2 ** 30
    system = platform.freedesktop_os_release()["PRETTY_NAME"]
    return f"{model}, {len(os.sched_getaffinity(0))} cores, {memory:.0f} GiB, {system}"
