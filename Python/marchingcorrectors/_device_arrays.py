# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Copies arrays on a CUDA device, of CuPy, PyTorch, Warp, Numba, JAX and others, to NumPy arrays. The arrays are
found by __cuda_array_interface__, else by __dlpack__. CUDA's driver copies them into page-locked memory, as fast as the bus allows."""
import contextlib
import ctypes
import functools
import os
import threading
import weakref

import numpy as np

from ._library import DeviceError, InvalidArgument

ON_CUDA = 2  # kDLCUDA
KINDS = {0: "i", 1: "u", 2: "f"}  # DLPack's codes of types.
CONTEXT_OF, DEVICE_OF, PORTABLE = 1, 9, 1  # CU_POINTER_ATTRIBUTE_CONTEXT, ..._DEVICE_ORDINAL, CU_MEMHOSTALLOC_PORTABLE


class Tensor(ctypes.Structure):
    """The struct DLTensor of DLPack."""

    _fields_ = [("data", ctypes.c_void_p), ("device_type", ctypes.c_int32), ("device", ctypes.c_int32), ("ndim", ctypes.c_int32),
                ("code", ctypes.c_uint8), ("bits", ctypes.c_uint8), ("lanes", ctypes.c_uint16),
                ("shape", ctypes.POINTER(ctypes.c_int64)), ("strides", ctypes.POINTER(ctypes.c_int64)),
                ("byte_offset", ctypes.c_uint64)]


def on_host(values, role):
    """Returns a NumPy copy of an array on a CUDA device, and anything else as it is."""
    interface = getattr(values, "__cuda_array_interface__", None)
    if interface is not None:
        if interface.get("mask") is not None:
            raise InvalidArgument(f"The {role} has masked elements. Remove such particles, or fill them.")
        dtype, stream = np.dtype(interface["typestr"]), interface.get("stream")
        return _copy(interface["data"][0], interface["shape"], dtype, interface.get("strides"), stream, role)
    if hasattr(values, "__dlpack_device__") and int(values.__dlpack_device__()[0]) == ON_CUDA:
        # Stream 1 is CUDA's legacy default stream. The library of the array makes this stream wait until the array is complete. The
        # capsule frees the tensor when Python deletes the capsule.
        capsule = values.__dlpack__(stream=1)
        pointer = ctypes.pythonapi.PyCapsule_GetPointer
        pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
        tensor = Tensor.from_address(pointer(capsule, b"dltensor"))
        if tensor.lanes != 1 or tensor.code not in KINDS and (tensor.code, tensor.bits) != (6, 8):
            raise InvalidArgument(f"The {role} has elements that NumPy lacks (DLPack's type {tensor.code}, {tensor.bits} bits). Convert it to "
                                  "float32.")
        dtype = np.dtype(f"{KINDS[tensor.code]}{tensor.bits // 8}" if tensor.code in KINDS else bool)
        shape = tuple(tensor.shape[:tensor.ndim])
        strides = tuple(dtype.itemsize * stride for stride in tensor.strides[:tensor.ndim]) if tensor.strides else None
        return _copy((tensor.data or 0) + tensor.byte_offset, shape, dtype, strides, 1, role)
    return values


def _copy(address, shape, dtype, strides, stream, role):
    """Copies all bytes from the lowest element to the highest one at once; the result has the original's strides."""
    if 0 in shape:
        return np.empty(shape, dtype)
    low, high = 0, int(np.prod(shape, dtype=np.int64)) * dtype.itemsize
    if strides is not None:
        ends = [(length - 1) * stride for length, stride in zip(shape, strides)]
        low, high = sum(min(end, 0) for end in ends), sum(max(end, 0) for end in ends) + dtype.itemsize
    try:
        driver = _open()
    except (OSError, DeviceError) as error:
        raise DeviceError(f"The {role} is on a CUDA device, but CUDA's driver cannot be used: {str(error).rstrip('.')}. "
                          "Copy it to the host first, as by array.get() or tensor.cpu().") from None
    block = driver.read(address + low, high - low, stream)
    return np.ndarray(shape, dtype, block, -low, strides)


class Driver:
    """CUDA's driver, and blocks of page-locked memory. A block that no array uses any more is used for a later array, because locking
    memory takes far longer than copying."""

    def __init__(self, library):
        self.library, self.lock, self.idle, self.primary = library, threading.Lock(), [], {}

    def call(self, name, *arguments):
        error = getattr(self.library, name)(*arguments)
        if error:
            text = ctypes.c_char_p()
            self.library.cuGetErrorString(error, ctypes.byref(text))
            raise DeviceError(f"CUDA's {name} failed: {(text.value or b'unknown error').decode(errors='replace')} ({error}).")

    @contextlib.contextmanager
    def current(self, context):
        self.call("cuCtxPushCurrent_v2", context)
        try:
            yield
        finally:
            self.call("cuCtxPopCurrent_v2", ctypes.byref(ctypes.c_void_p()))

    def contexts_of(self, address):
        """Returns the context of the array at this address, and the primary context of its device, which stays retained. Memory of
        pools and of virtual addresses has no context of its own, so the primary context is returned twice."""
        context, device = ctypes.c_void_p(), ctypes.c_int()
        self.call("cuPointerGetAttribute", ctypes.byref(device), DEVICE_OF, ctypes.c_uint64(address))
        if device.value not in self.primary:
            primary = ctypes.c_void_p()
            self.call("cuDevicePrimaryCtxRetain", ctypes.byref(primary), device)
            self.primary[device.value] = primary
        primary = self.primary[device.value]
        failed = self.library.cuPointerGetAttribute(ctypes.byref(context), CONTEXT_OF, ctypes.c_uint64(address))
        return (primary if failed or not context.value else context), primary

    def read(self, address, size, stream):
        with self.lock:
            own, primary = self.contexts_of(address)
            with self.current(primary):
                memory, room = self.take(size)
            block = (ctypes.c_char * size).from_address(memory)
            # Python may delete a block in a thread that holds the lock already, so the block's finalizer must not need the
            # lock. A list's append needs no lock.
            weakref.finalize(block, self.idle.append, (memory, room)).atexit = False
            with self.current(own):
                if stream is not None:
                    self.call("cuStreamSynchronize", ctypes.c_void_p(stream))
                self.call("cuMemcpyDtoH_v2", ctypes.c_void_p(memory), ctypes.c_uint64(address), ctypes.c_size_t(size))
        return block

    def take(self, size):
        """Returns (address, size) of the smallest idle block with enough room. If there is none, frees the largest idle
        block, and allocates one."""
        block = min((each for each in self.idle if each[1] >= size), key=lambda each: each[1], default=None) or max(
            self.idle, key=lambda each: each[1], default=None)
        if block:
            self.idle.remove(block)
            if block[1] >= size:
                return block
            self.call("cuMemFreeHost", ctypes.c_void_p(block[0]))
        memory, room = ctypes.c_void_p(), size + size // 8
        self.call("cuMemHostAlloc", ctypes.byref(memory), ctypes.c_size_t(room), PORTABLE)
        return memory.value, room


@functools.lru_cache(maxsize=None)
def _open():
    library = ctypes.CDLL("nvcuda.dll" if os.name == "nt" else "libcuda.so.1")
    driver = Driver(library)
    driver.call("cuInit", 0)
    return driver
