# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The core's shared library, its errors, and the devices that it finds."""
import ctypes
import importlib.metadata
import os
import shutil
import sys
import tempfile
import threading
from pathlib import Path

from . import _structs as c

NO_DEVICE = ("No OpenCL device was found. Install the driver of a GPU, or PoCL, which runs on the CPU: "
             'pip install "marching-correctors[pocl]".')


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
    library = ctypes.CDLL(str(Path(__file__).with_name("_mcor.so")))
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
        "mcor_decompose_gradients": (ctypes.c_int, [pointer(ctypes.c_double), ctypes.c_int64,
                                                    pointer(c.mcor_flow)]),
        "mcor_name_rank": (ctypes.c_int, [ctypes.c_int, ctypes.c_char_p]),
        "mcor_find_fluid_value": (ctypes.c_int, [ctypes.c_char_p, ctypes.c_double, ctypes.c_double,
                                                 pointer(ctypes.c_double)]),
        "mcor_view_rank": (ctypes.c_int, [ctypes.c_char_p, ctypes.c_int, ctypes.c_int, ctypes.c_int]),
        "mcor_find_iso_value": (ctypes.c_int, [pointer(c.mcor_input), pointer(c.mcor_ranks),
                                               pointer(ctypes.c_double), pointer(ctypes.c_double)]),
        "mcor_opencl_set_driver": (None, [ctypes.c_char_p]),
        "mcor_opencl_use_driver": (ctypes.c_int, [ctypes.c_int]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


lib = _open()
_free = ctypes.CDLL(None).free
_free.restype, _free.argtypes = None, [ctypes.c_void_p]

_state_lock = threading.Lock()
_ready_in = None  # the process in which OpenCL was started


def pocl_library():
    """The driver that the extra "pocl" installed; None where it is not. It lies in a folder of its
    package's choice, so that the list of its files is asked. ParaView, which loads the plugin's file
    from anywhere, looks for no package there: hence the folder beside ours."""
    beside = str(Path(__file__).parent.parent)
    for found in importlib.metadata.distributions(name="pocl-binary-distribution", path=[*sys.path, beside]):
        for file in found.files or []:
            if file.name.startswith("libpocl") and ".so" in file.name:
                return os.path.realpath(str(file.locate()))
    return None


def _give_pocl_a_folder():
    """PoCL finds no device where it cannot write its cache: then the cache ends with this process."""
    if os.environ.get("POCL_CACHE_DIR"):
        return
    shared = os.environ.get("XDG_CACHE_HOME")
    cache = Path(shared) if shared else Path(os.environ.get("HOME") or tempfile.gettempdir()) / ".cache"
    folder = cache / "pocl" / "kcache"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK | os.X_OK):
            return
    except OSError:
        pass
    temporary = tempfile.mkdtemp(prefix="marching-correctors-")
    os.environ["POCL_CACHE_DIR"] = temporary
    os.environ["MCOR_COMPILER"] = ""  # nobody else is to write there when it is removed
    _remove_at_exit(temporary)


def _give_pocl_a_linker():
    """PyPI's PoCL ends the process where it finds no "ld" with a compiler's libraries. Ours links its
    kernels, and hands everything else on to the next one on the PATH."""
    folder = str(Path(__file__).with_name("linker"))
    path = os.environ.get("PATH", os.defpath).split(os.pathsep)
    if os.path.isdir(folder) and folder not in path:
        os.environ["PATH"] = os.pathsep.join([folder, *path])


def _remove_at_exit(folder):
    import atexit

    pid = os.getpid()
    atexit.register(lambda: os.getpid() == pid and shutil.rmtree(folder, ignore_errors=True))


def start(wanted=""):
    """What must be done once before OpenCL is asked for anything. The extra's PoCL serves where the
    system gives no device, or where a device is asked for by the name of PoCL and there is none."""
    global _ready_in
    with _state_lock:
        if _ready_in is None:
            _ready_in = os.getpid()
            _give_pocl_a_folder()
            lib.mcor_opencl_set_driver((pocl_library() or "").encode())
        elif _ready_in != os.getpid():
            raise DeviceError("OpenCL was started before this process was forked, and drivers do not survive "
                              'that: use the "spawn" method of multiprocessing, or extract here first.')
        asked = "pocl" in wanted.lower() and "portable computing" not in _list().lower()
        if lib.mcor_opencl_use_driver(int(asked)):
            _give_pocl_a_linker()
            # The process that compiles kernels beside this one lists devices as this one does.
            os.environ["MCOR_OPENCL_DRIVER"] = pocl_library() or ""


def _list():
    text = ctypes.c_void_p()
    lib.mcor_list_devices(ctypes.byref(text))
    try:
        return (ctypes.string_at(text) if text else b"").decode(errors="replace")
    finally:
        _free(text)


def devices():
    """The OpenCL devices, "device (platform)" each, in the order of their numbers.

    Those of the system's drivers, as its loader lists them; where there is none, that of the PoCL
    which the extra installs. An empty list: there is no device.
    """
    start()
    return [line.partition(": ")[2] for line in _list().splitlines()]
