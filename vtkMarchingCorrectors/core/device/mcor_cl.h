/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cl_h
#define mcor_cl_h

/* OpenCL: device, programs, buffers, launches. Only mcor_cl_*.c call OpenCL's functions (cl...). */

#include "mcor.h"
#include "mcor_opencl.h"

#include <stdbool.h>

#define MCOR_KEPT_BUFFERS 32 /* most buffers kept for reuse */
#define MCOR_LOCKED_LIMIT 32 /* most mcor_locked */
/* Scans and sorts cut their arrays into at most this many segments. */
#define MCOR_SEGMENT_LIMIT 4096

/* A device buffer that grows; its content is undefined after it grew. All zero: no buffer yet. */
typedef struct mcor_buffer
{
  cl_mem mem;
  size_t size; /* bytes */
} mcor_buffer;

/* Memory of the host that a driver has locked. If the device has memory of its own, the host sees a
 * mapped buffer as a copy in this locked memory. */
typedef struct mcor_locked
{
  cl_mem mem, of; /* of: the buffer that is mapped; NULL: none */
  void* host;
  size_t size, written; /* written: bytes to copy to the buffer until it is unmapped */
  /* How many bytes the driver has begun to copy to or from the buffer. mcor_finish resets the
   * number to 0, unless the memory is mapped to be written. */
  size_t sent;
} mcor_locked;

/* One variant of the programs: what their compilation depends on, besides the device. */
typedef struct mcor_build
{
  mcor_sph_kernel sph_kernel;
  mcor_field field;
  mcor_type precision;
  bool solids;
} mcor_build;

/* Programs are built when they are first needed, or earlier, see mcor_build_ahead. Their sources
 * are listed in kernels/programs.cmake, their kernels in mcor_program.c. */
typedef enum mcor_program
{
  /* The next five programs depend neither on the SPH kernel, nor on the field, nor on solids, so
   * they are compiled once for each precision. */
  MCOR_PROGRAM_GRID,    /* scans, sorts, the search grid */
  MCOR_PROGRAM_BRICKS,  /* blocks and bricks */
  MCOR_PROGRAM_CELLS,   /* marching, and triangles that are cut; lines in two dimensions */
  MCOR_PROGRAM_LEAVES,  /* adaptive cubes */
  MCOR_PROGRAM_CHOICES, /* topology, boxes, pairs */
  /* The next seven programs make surfaces. They are compiled for each mcor_build (SPH kernel,
   * field, precision, solids), but two of them are the same for all fields. */
  MCOR_PROGRAM_ATTRIBUTES, /* does not depend on the field */
  MCOR_PROGRAM_DENSITY,    /* computed volumes, of any call; does not depend on the field */
  MCOR_PROGRAM_NODES,      /* seeds and values at nodes */
  MCOR_PROGRAM_VERTICES,   /* correction */
  MCOR_PROGRAM_TRIM,
  MCOR_PROGRAM_SHAPE, /* boundary eigenvalue, curvature, values at points of caps */
  MCOR_PROGRAM_RARE,  /* seeds of pairs, nodes in two dimensions */
  /* For mcor_probe, mcor_derive and mcor_widen. This program does not depend on the field and, on
   * devices that use the GPU form of kernels, not on solids either. */
  MCOR_PROGRAM_PROBE,
  MCOR_PROGRAM_COUNT
} mcor_program;
/* Sets of programs, as bits. LATTICE: the programs that depend on the precision alone. PROBE: the
 * program for probes. FIELD: the programs for surfaces, compiled for each mcor_build. If
 * cl.builds_sets, each set is one program: MCOR_PROGRAM_GRID, _PROBE and _NODES, in this order. */
#define MCOR_PARTS_LATTICE ((1 << MCOR_PROGRAM_ATTRIBUTES) - 1)
#define MCOR_PARTS_PROBE (1 << MCOR_PROGRAM_PROBE)
#define MCOR_PARTS_FIELD (MCOR_PARTS_PROBE - 1 - MCOR_PARTS_LATTICE)

typedef struct mcor_kernel
{
  char name[48];
  cl_kernel kernel;
  mcor_program program;
  /* Whether a launch took place, which may have made the driver compile. First index: whether the
   * first work-item's number is above 0. Second index: whether there were MCOR_LARGE_LAUNCH items
   * or more. */
  bool launched[2][2];
  double part; /* work-items launched at once, see mcor_enqueue_cut; 0: unknown so far */
} mcor_kernel;

/* Called between launches and, with `compiles`, before and while a driver compiles, which may take
 * seconds. A status other than MCOR_OK ends the call. */
typedef mcor_status (*mcor_observer)(mcor_context* context, bool compiles);

typedef struct mcor_cl
{
  cl_platform_id platform;
  cl_device_id device;
  cl_device_id share; /* the device, if it is a share of another one; else NULL */
  cl_context context;
  struct mcor_pool* pool;              /* threads of the built-in device; else NULL */
  struct mcor_profile* profile;        /* NULL: none is wanted */
  cl_command_queue queue, timed_queue; /* timed_queue measures times, for first launches */
  cl_program programs[MCOR_PROGRAM_COUNT];
  struct mcor_builder* builder; /* programs that are built ahead; NULL: none */
  mcor_build build;     /* the variant for which the programs are built */
  mcor_kernel* kernels; /* kernels made so far */
  int kernel_count;
  int64_t kernel_room;
  int device_number, units;       /* number in the list of devices; compute units */
  cl_uint width;                  /* of the device's vectors of float */
  int place, count; /* number of this process; how many processes share the devices */
  bool is_default, is_replaced;   /* no device was named; the first choice lacked a build */
  bool is_cpu;                    /* kernels have the form for CPUs */
  bool builds_sets;               /* each set of programs is one program */
  bool is_apart;                  /* memory is not the host's, see mcor_locked */
  bool has_fp64, rounds_division; /* the latter: divisions and roots can be exact to the last bit */
  int lanes;              /* evaluation points that a work-item treats at once */
  int segments;           /* segments into which scans and sorts cut their arrays */
  size_t real_size, fix_size;
  uint64_t device_memory, largest_buffer;
  uint64_t memory_limit;               /* bytes of device_memory that the call under way may use */
  int64_t bytes, bytes_peak;           /* bytes in all buffers, kept ones included */
  mcor_buffer kept[MCOR_KEPT_BUFFERS]; /* see mcor_release */
  int kept_count;
  mcor_locked locked[MCOR_LOCKED_LIMIT];
  /* kept_bytes: bytes of kept buffers. used_peak, used_before: the most bytes in all other buffers,
   * in this call and in the last call. */
  int64_t kept_bytes, used_peak, used_before;
  double build_seconds;   /* how long the present call has built programs */
  mcor_observer observer; /* progress of the present call; NULL: none */
  double terms; /* about the number of terms in the sum at a point, for mcor_enqueue_cut */
  bool compiles; /* drivers compile a kernel at its first launch: the last such launch took long */
  char device_name[128], platform_name[128];
} mcor_cl;

/* One kernel argument. Reals are passed in the program's precision. */
typedef struct mcor_arg
{
  enum
  {
    MCOR_ARG_BUFFER,
    MCOR_ARG_INT,
    MCOR_ARG_REAL
  } kind;
  const mcor_buffer* buffer;
  int integer;
  double real;
} mcor_arg;

#define MCOR_BUFFER(b)                                                                             \
  {                                                                                                \
    .kind = MCOR_ARG_BUFFER, .buffer = (b)                                                         \
  }
#define MCOR_INT(i)                                                                                \
  {                                                                                                \
    .kind = MCOR_ARG_INT, .integer = (i)                                                           \
  }
#define MCOR_REAL(r)                                                                               \
  {                                                                                                \
    .kind = MCOR_ARG_REAL, .real = (r)                                                             \
  }

/* How much one work-item does. Light: a few operations for one of many elements; medium: a brick or
 * a run of elements; heavy: an evaluation of the field. On a CPU each medium or heavy work-item is
 * a work-group of its own, because CPUs run code faster without a loop over the group. */
typedef enum mcor_load
{
  MCOR_LIGHT,
  MCOR_MEDIUM,
  MCOR_HEAVY
} mcor_load;

#define MCOR_LAUNCH(context, name, load, items, ...)                                               \
  mcor_launch(context, name, load, (size_t)(items), (const mcor_arg[]){ __VA_ARGS__ },             \
    sizeof((const mcor_arg[]){ __VA_ARGS__ }) / sizeof(mcor_arg))

/* For a launch of this many work-items or more, PoCL compiles a kernel once more. */
#define MCOR_LARGE_LAUNCH 65535

/* Opens a device by name or number. NULL or "": the device that MCOR_DEVICE in the environment
 * names, or else the default. place, count: see mcor_create_shared_context. */
mcor_status mcor_open_device(mcor_context* context, const char* device, int place, int count);
/* Called when a call begins. Does nothing if the user named a device. Otherwise, if the open device
 * cannot run the build, or replaces a device that could not run an earlier build, opens the best
 * device that can run this build. Fails if no device can run it. release: frees everything on the
 * old device first. */
mcor_status mcor_settle_device(
  mcor_context* context, const mcor_build* build, void (*release)(mcor_context* context));
void mcor_close_device(mcor_context* context);
/* Chooses the variant of the kernels that is used from now on. Kernels that fit it are kept. */
mcor_status mcor_choose_build(mcor_context* context, const mcor_build* build);
/* Chooses the build, and starts threads that build the missing ones of `programs` (a set of bits),
 * in the order in which a run needs them. Does neither on the built-in device, or if only one
 * thread may be used. */
mcor_status mcor_build_ahead(mcor_context* context, const mcor_build* build, int programs);
/* Returns about how many seconds the missing programs take to build; 0: none, or not known. */
double mcor_build_rest(mcor_cl* cl);
/* Waits for programs under way, ends the threads that build, and keeps the built programs. */
void mcor_end_building(mcor_cl* cl);
mcor_status mcor_reserve(mcor_context* context, mcor_buffer* buffer, size_t bytes);
/* Releases a buffer. A large one is kept for the next request of about its size: the first touch
 * of memory takes longer than most work in it, and successive phases and calls have arrays of
 * similar sizes. */
void mcor_release(mcor_context* context, mcor_buffer* buffer);
/* Frees kept buffers until all buffers together have at most `most` bytes, or none is kept. */
void mcor_drop_kept(mcor_context* context, int64_t most);
/* Frees the locked memory that is not in use. */
void mcor_drop_locked(mcor_context* context);
/* Called when a call begins: frees kept buffers beyond what the last call needed. */
void mcor_begin_buffers(mcor_context* context);
mcor_status mcor_write(mcor_context* context, mcor_buffer* buffer, const void* data, size_t bytes);
mcor_status mcor_read(
  mcor_context* context, const mcor_buffer* buffer, size_t offset, void* data, size_t bytes);
/* Maps the first `bytes` of a buffer, for the host to read or, if `write` is set, to write all of
 * them. Nothing is copied where host and device share memory. *data becomes NULL after a failure,
 * or if `bytes` is 0 and the buffer has no memory. */
mcor_status mcor_map(
  mcor_context* context, const mcor_buffer* buffer, size_t bytes, bool write, void** data);
mcor_status mcor_unmap(mcor_context* context, const mcor_buffer* buffer, void** data);
/* Begins to copy to the device the first `bytes` of a buffer that is mapped to be written, while
 * the host writes the bytes behind them. Does nothing where host and device share memory. */
mcor_status mcor_send(mcor_context* context, const void* data, size_t bytes);
/* One of the buffers that mcor_map_all maps. *data must be NULL before the call. */
typedef struct mcor_mapping
{
  const mcor_buffer* buffer;
  size_t bytes;
  void** data;
} mcor_mapping;
/* Maps the buffers for reading, in order, up to the first failure. */
mcor_status mcor_map_all(mcor_context* context, const mcor_mapping* mappings, int count);
/* Maps as mcor_map_all does, but the host may read only after the next mcor_finish. */
mcor_status mcor_begin_mapping(mcor_context* context, const mcor_mapping* mappings, int count);
/* Unmaps the buffers that are mapped. Returns `status` or, if it is MCOR_OK, the first failure. */
mcor_status mcor_unmap_all(
  mcor_context* context, const mcor_mapping* mappings, int count, mcor_status status);
mcor_status mcor_fill(mcor_context* context, mcor_buffer* buffer, uint8_t byte, size_t bytes);
/* Fills a buffer with copies of a real number. Only for devices with memory of their own. */
mcor_status mcor_fill_reals(
  mcor_context* context, mcor_buffer* buffer, double value, size_t count);
/* Makes room for `last` bytes, and fills the bytes [first, last). */
mcor_status mcor_fill_range(
  mcor_context* context, mcor_buffer* buffer, uint8_t byte, size_t first, size_t last);
/* Moves the memory of buffer `from` to `to`; `from` is then empty. */
void mcor_take_buffer(mcor_context* context, mcor_buffer* from, mcor_buffer* to);
/* Makes room for `bytes`, keeping the first `old` bytes. */
mcor_status mcor_extend(mcor_context* context, mcor_buffer* buffer, size_t old, size_t bytes);
/* Appends to a buffer that holds `old` bytes. */
mcor_status mcor_append_bytes(
  mcor_context* context, mcor_buffer* buffer, size_t old, const void* data, size_t bytes);
mcor_status mcor_copy(
  mcor_context* context, const mcor_buffer* from, mcor_buffer* to, size_t to_offset, size_t bytes);
mcor_status mcor_launch(mcor_context* context, const char* name, mcor_load load, size_t items,
  const mcor_arg* args, size_t arg_count);
mcor_status mcor_finish(mcor_context* context);
/* Appends what the call has cost to the profile, if there is one. status: the result of the call.
 * Returns `status` or, if it is MCOR_OK and the rows cannot be written, the failure to write. */
mcor_status mcor_write_profile(
  mcor_context* context, const mcor_statistics* statistics, mcor_status status);
void mcor_close_profile(mcor_context* context);

#endif
