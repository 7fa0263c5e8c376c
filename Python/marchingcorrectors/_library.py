# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The core's shared library, its errors, and the devices that it finds."""
import ctypes
import os
import threading
from pathlib import Path
from typing import List

from . import _structs as c

NO_DEVICE = ("No device was found: this processor has none of the instruction sets of the built-in one, and there "
             "is no OpenCL driver. Install the driver of a GPU.")


class Error(RuntimeError):
    """A call failed; the sentence says what was wrong, with which array or particle, and what to do."""


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


ERRORS = {"MCOR_INVALID_ARGUMENT": InvalidArgument, "MCOR_INVALID_DATA": InvalidData,
          "MCOR_OUT_OF_CAPACITY": OutOfCapacity, "MCOR_DEVICE_ERROR": DeviceError,
          "MCOR_CANCELLED": Cancelled}
ERRORS = {c.ENUMS["mcor_status"][name]: error for name, error in ERRORS.items()}


def _open():
    library = ctypes.CDLL(str(Path(__file__).with_name("_mcor.dll" if os.name == "nt" else "_mcor.so")))
    context, pointer = ctypes.c_void_p, ctypes.POINTER
    signatures = {
        "mcor_create_context": (ctypes.c_int, [ctypes.c_char_p, pointer(context)]),
        "mcor_free_context": (None, [context]),
        "mcor_release_memory": (None, [context]),
        "mcor_list_devices": (ctypes.c_int, [pointer(ctypes.c_void_p)]),
        "mcor_last_error": (ctypes.c_char_p, [context]),
        "mcor_phase_name": (ctypes.c_char_p, [ctypes.c_int]),
        "mcor_sph_kernel_name": (ctypes.c_char_p, [ctypes.c_int]),
        "mcor_find_sph_kernel": (ctypes.c_int, [ctypes.c_char_p]),
        "mcor_support_factor": (ctypes.c_double, [ctypes.c_int]),
        "mcor_set_default_options": (None, [pointer(c.mcor_options)]),
        "mcor_extract": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                        pointer(c.mcor_surface)]),
        "mcor_free_surface": (None, [pointer(c.mcor_surface)]),
        "mcor_probe": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                      pointer(c.mcor_array), ctypes.c_int64, pointer(c.mcor_samples)]),
        "mcor_free_samples": (None, [pointer(c.mcor_samples)]),
        "mcor_derive": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                       ctypes.c_int, pointer(c.mcor_derivatives)]),
        "mcor_free_derivatives": (None, [pointer(c.mcor_derivatives)]),
        "mcor_widen": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                      pointer(c.mcor_widening)]),
        "mcor_free_widening": (None, [pointer(c.mcor_widening)]),
        "mcor_gauge": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                      pointer(c.mcor_gauge_line), ctypes.c_int64, pointer(c.mcor_gauges)]),
        "mcor_free_gauges": (None, [pointer(c.mcor_gauges)]),
        "mcor_flux": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                     pointer(c.mcor_section), ctypes.c_int64, pointer(c.mcor_fluxes)]),
        "mcor_free_fluxes": (None, [pointer(c.mcor_fluxes)]),
        "mcor_project": (ctypes.c_int, [context, pointer(c.mcor_input), pointer(c.mcor_options),
                                        pointer(c.mcor_view), pointer(c.mcor_projection)]),
        "mcor_free_projection": (None, [pointer(c.mcor_projection)]),
        "mcor_decompose_gradients": (ctypes.c_int, [pointer(ctypes.c_double), ctypes.c_int64,
                                                    pointer(c.mcor_flow)]),
        "mcor_name_priority": (ctypes.c_int, [ctypes.c_int, ctypes.c_char_p]),
        "mcor_find_fluid_value": (ctypes.c_int, [ctypes.c_char_p, ctypes.c_double, ctypes.c_double,
                                                 pointer(ctypes.c_double)]),
        "mcor_view_priority": (ctypes.c_int, [ctypes.c_char_p, ctypes.c_int, ctypes.c_int, ctypes.c_int]),
        "mcor_find_smoothing_lengths": (ctypes.c_int, [pointer(c.mcor_input), pointer(c.mcor_options), ctypes.c_double,
                                                       ctypes.c_int64, pointer(ctypes.c_double), pointer(ctypes.c_void_p)]),
        "mcor_sum_densities": (ctypes.c_int, [pointer(c.mcor_input), pointer(c.mcor_options), ctypes.c_int64,
                                              pointer(ctypes.c_double), pointer(ctypes.c_void_p)]),
        "mcor_find_dimension": (ctypes.c_int, [pointer(c.mcor_input), ctypes.c_void_p, ctypes.c_int]),
        "mcor_least_smoothing_length": (ctypes.c_double, [pointer(c.mcor_input)]),
        "mcor_estimate_cells": (ctypes.c_double, [pointer(c.mcor_input), pointer(c.mcor_options), ctypes.c_double]),
        "mcor_describe_estimate": (ctypes.c_void_p, [ctypes.c_double]),
        "mcor_describe_smoothing_length": (ctypes.c_void_p, [pointer(c.mcor_input), pointer(c.mcor_statistics)]),
        "mcor_describe_volume": (ctypes.c_void_p, [pointer(c.mcor_input)]),
        "mcor_describe_single_points": (ctypes.c_void_p, [ctypes.c_double, ctypes.c_double]),
        "mcor_describe_measures": (ctypes.c_void_p, [pointer(c.mcor_statistics)]),
        "mcor_find_iso_value": (ctypes.c_int, [pointer(c.mcor_input), pointer(c.mcor_ranks),
                                               pointer(ctypes.c_double), pointer(ctypes.c_double)]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


lib = _open()
_free = ctypes.CDLL("ucrtbase" if os.name == "nt" else None).free  # of the C library that the core uses
_free.restype, _free.argtypes = None, [ctypes.c_void_p]

_state_lock = threading.Lock()
_ready_in = None  # the process in which OpenCL was started


def start():
    """Before OpenCL is asked for anything."""
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
    try:
        return (ctypes.string_at(text) if text else b"").decode(errors="replace")
    finally:
        _free(text)


def devices() -> List[str]:
    """The devices, "device (platform)" each, in the order of their numbers: the built-in one, whose kernels
    are in this package, then those of OpenCL drivers, as the system's loader lists them.
    """
    start()
    return [line.partition(": ")[2] for line in _list().splitlines()]
