/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_opencl_h
#define mcor_opencl_h

/* The library of an OpenCL driver of one's own (PoCL's of PyPI), which need not be known to the
 * system; NULL or "": none. It is opened where the system gives no device. */
void mcor_opencl_set_driver(const char* path);

/* Opens the driver of one's own: now if `always` is set, else where the system gives no device. Its
 * devices are listed after all others. Returns whether it is open. */
int mcor_opencl_use_driver(int always);

#endif
