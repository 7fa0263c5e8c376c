/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_internal_h
#define mcor_internal_h

/* Functions that files of the core call in each other. */

#include "mcor_say.h"
#include "mcor_state.h"
#include "mcor_system.h"

#include <math.h>
#include <string.h>

#define MCOR_TRY(call)                                                                             \
  do                                                                                               \
  {                                                                                                \
    const mcor_status mcor_try_status_ = (call);                                                   \
    if (mcor_try_status_ != MCOR_OK)                                                               \
    {                                                                                              \
      return mcor_try_status_;                                                                     \
    }                                                                                              \
  } while (0)

/* If the condition holds, the calling function keeps the sentence that explains the status, and
 * returns the status. Further arguments: MCOR_SAY(CODE), and values for the sentence's formats. */
#define MCOR_FAIL_IF(condition, context, status, ...)                                              \
  do                                                                                               \
  {                                                                                                \
    if (condition)                                                                                 \
    {                                                                                              \
      return mcor_fail(context, status, __VA_ARGS__);                                              \
    }                                                                                              \
  } while (0)

/* If `status` is MCOR_OK, makes a call, and sets `status` to the call's result. It is for functions
 * that must free something before they return. */
#define MCOR_THEN(status, call) ((status) = (status) == MCOR_OK ? (call) : (status))
/* Yields the status; if it is a failure, first frees what the call would have returned. */
#define MCOR_OR_FREE(status, free_result, result)                                                  \
  ((status) == MCOR_OK ? MCOR_OK : (free_result(result), (status)))

/* MCOR_LIST: an array that grows. MCOR_APPEND appends a value; if memory runs out, the calling
 * function returns the failure. */
#define MCOR_LIST(type)                                                                            \
  struct                                                                                           \
  {                                                                                                \
    type* of; /* [room] */                                                                         \
    int64_t count, room;                                                                           \
  }
#define MCOR_APPEND(context, list, ...)                                                            \
  do                                                                                               \
  {                                                                                                \
    if ((list)->count == (list)->room)                                                             \
    {                                                                                              \
      MCOR_TRY(mcor_make_room(                                                                     \
        context, (void**)&(list)->of, (list)->count, &(list)->room, sizeof *(list)->of));          \
    }                                                                                              \
    (list)->of[(list)->count++] = __VA_ARGS__;                                                     \
  } while (0)

/* Keeps the sentence in the context, and returns the status. The context may be NULL if nobody will
 * ask for the sentence. Use it as mcor_fail(context, status, MCOR_SAY(CODE), ...). */
mcor_status mcor_fail(
  mcor_context* context, mcor_status status, mcor_says code, const char* format, ...)
#if defined(__GNUC__)
  __attribute__((format(printf, 4, 5)))
#endif
  ;
#define MCOR_NO_MESSAGE ((mcor_message){ MCOR_SAYS_NOTHING, NULL })
/* mcor_text returns a new text. mcor_append frees the given text, and returns a new text: the given
 * text with more text behind it. The caller frees the result. NULL: memory ran out in this call or,
 * if `text` is NULL, in an earlier call. */
char* mcor_text(const char* format, ...)
#if defined(__GNUC__)
  __attribute__((format(printf, 1, 2)))
#endif
  ;
char* mcor_append(char* text, const char* format, ...)
#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  ;
/* Returns the small letter of a letter in any locale; in a Turkish one, tolower('I') is no i. */
static inline char mcor_small_letter(char c)
{
  return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}
/* Whether `part` occurs in `text`, ignoring case. */
bool mcor_contains(const char* text, const char* part);
/* Writes to out [size] the text with words in place of its slots, such as {cube_size}. A longer
 * result is cut. Returns the length of the whole result, as snprintf does. */
size_t mcor_fill_text(const char* text, mcor_word word, void* user, char* out, size_t size);
/* Bytes for a word that mcor_fill_text fills in, with the final 0. A longer word is cut. */
#define MCOR_WORD_SIZE 256
double mcor_seconds(void);
/* An SPH kernel W = norm / h^3 w(q), see mcor_sph_kernel.h. In arrays of two, the first element is
 * for three dimensions, the second for two. */
typedef struct mcor_kernel_row
{
  const char *name, *norm_text, *support_text, *neighbours[2];
  double support, norm, variance[2];
  double plane_factor; /* norm in two dimensions / norm in three */
  bool is_tensor;      /* w is a product of three functions, one along each axis */
} mcor_kernel_row;
const mcor_kernel_row* mcor_kernel_of(mcor_sph_kernel kernel);

/* Fails for lack of host memory if `complete` is false: an allocation on the host failed. */
mcor_status mcor_allocated(mcor_context* context, bool complete);
/* Makes room for one more element behind the first `count` of an array, which has room for
 * `room` elements of `width` bytes. */
mcor_status mcor_make_room(
  mcor_context* context, void** array, int64_t count, int64_t* room, size_t width);

/* Returns element i of an array of the device's real type. */
static inline double mcor_get_real(const mcor_context* context, const void* array, int64_t i)
{
  return context->cl.real_size == sizeof(float) ? (double)((const float*)array)[i]
                                                : ((const double*)array)[i];
}

static inline void mcor_put_real(const mcor_context* context, void* array, int64_t i, double value)
{
  if (context->cl.real_size == sizeof(float))
  {
    ((float*)array)[i] = (float)value;
    return;
  }
  ((double*)array)[i] = value;
}

static inline double mcor_power(double x, int axes)
{
  return axes == 2 ? x * x : x * x * x;
}

/* Returns the number rounded to the device's precision. */
static inline double mcor_real_of(const mcor_context* context, double value)
{
  return context->cl.real_size == sizeof(float) ? (double)(float)value : value;
}

/* The largest number of elements that kernels count. It is an int even if it is rounded up to whole
 * work-groups or batches. */
#define MCOR_COUNT_LIMIT (INT32_MAX - 4095)
/* The most lattice nodes along an axis. Fixed point of single precision then resolves 2^-9
 * cubes. */
#define MCOR_LATTICE_LIMIT (1 << 20)
/* The most cubes along an axis for a lattice that is cut to a box or to points; particles with long
 * supports may lie far outside of such a lattice. Fixed point then resolves 2^-7 cubes. */
#define MCOR_CUT_LIMIT (1 << 22)
/* A node's key has 21 bits for each axis: a lattice has at most MCOR_NODE_LIMIT nodes along it.
 * A cell's key has 62 bits, and two flags above them (MCOR_RING_CELL): a lattice has at most
 * MCOR_KEY_LIMIT cells. */
#define MCOR_NODE_LIMIT (1 << 21)
#define MCOR_KEY_LIMIT 4.6e18

/* Whether vertex v is in the output, as point scanned[v] of its mesh. scanned: for each vertex, the
 * number of output vertices before it, see mcor_number_vertices. */
static inline bool mcor_is_output(const cl_int* scanned, int64_t v)
{
  return scanned[v] != scanned[v + 1];
}

/* Returns the input index of particle i of the device. */
static inline int64_t mcor_source_of(const mcor_context* context, int64_t i)
{
  return context->source ? context->source[i] : i;
}

/* Returns the number of batches that `count` particles or triangles, at least 1, need. */
static inline int mcor_batches(const mcor_context* context, int count)
{
  return (count - 1) / MCOR_BATCH_OF(context->cl.lanes) + 1;
}

/* Whether the surface is to have this array. */
static inline bool mcor_wants(const mcor_context* context, mcor_output output)
{
  return context->run.options->outputs & output;
}

/* Returns options.wall_share, with the default in place of "auto"; below 0: it is measured. */
static inline double mcor_asked_share(const mcor_options* options)
{
  return options->wall_share != MCOR_WALL_SHARE_AUTO ? options->wall_share
    : options->field == MCOR_WEIGHT_SUM              ? 0
                                                     : MCOR_WALL_SHARE_MEASURED;
}

/* Whether the call needs solids. A free surface needs them only if it ends at solids. */
static inline bool mcor_uses_solids(const mcor_input* input, const mcor_options* options)
{
  return !input->ignore_solids &&
    (options->field != MCOR_WEIGHT_SUM || mcor_asked_share(options) != 0);
}

/* Returns the wall share in use, given or measured. */
static inline double mcor_wall_share(const mcor_context* context)
{
  const double share = mcor_asked_share(context->run.options);
  return share < 0 ? context->measure.wall_share : share;
}

/* Whether the surface also ends where the solids' share of the weight becomes too large. */
static inline bool mcor_ends_at_solids(const mcor_context* context)
{
  return context->grid.has_solids && mcor_wall_share(context) > 0;
}

/* Returns the least share that fluid must have in the weight sum; 0: no share is needed. */
static inline double mcor_fluid_share(const mcor_context* context)
{
  return mcor_ends_at_solids(context) ? 1 - mcor_wall_share(context) : 0;
}

/* Returns the variant of the kernels that a call needs. */
static inline mcor_build mcor_build_of(const mcor_options* options, bool solids)
{
  return (mcor_build){ options->sph_kernel, options->field, options->precision, solids };
}

/* Whether seeds are the paper's pairs of neighbouring particles, one above the iso value, the other
 * below it. A free surface has no such pairs, because no scalar is contoured. */
static inline bool mcor_wants_pairs(const mcor_options* options)
{
  return options->seeds == MCOR_PAIRS && options->field != MCOR_WEIGHT_SUM;
}

static inline bool mcor_uses_pairs(const mcor_context* context)
{
  return mcor_wants_pairs(context->run.options);
}

/* A function that does the work of one call, and writes to `result`, e.g. a mcor_surface. It first
 * frees what a failed attempt may have left in the result. */
typedef mcor_status (*mcor_body)(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* result);

/* Runs the body. If memory runs out, frees what the context keeps. If this sets memory free, and
 * there are no ranks, runs the body once more. Fails if mcor_create_context failed. */
mcor_status mcor_run_call(mcor_context* context, const mcor_input* input,
  const mcor_options* options, bool uses_solids, mcor_statistics* statistics, mcor_body body,
  void* result);
/* Fails if options.smooth is set, but the options that it stands for are not; see
 * mcor_spell_out. */
mcor_status mcor_check_spelled_out(mcor_context* context, const mcor_options* options);
/* Frees everything on the device, including tables that outlive calls. */
void mcor_release_all_data(mcor_context* context);
mcor_status mcor_prepare(
  mcor_context* context, const mcor_input* input, const mcor_options* options);

/* Frees buffers; they may be empty already. */
#define MCOR_RELEASE(context, ...)                                                                 \
  mcor_release_all(context, (mcor_buffer* const[]){ __VA_ARGS__ },                                 \
    sizeof((mcor_buffer* const[]){ __VA_ARGS__ }) / sizeof(mcor_buffer*))
void mcor_release_all(mcor_context* context, mcor_buffer* const buffers[], size_t count);
/* Frees all buffers of a struct that consists of buffers. */
#define MCOR_RELEASE_EACH(context, s)                                                              \
  mcor_release_each(context, (mcor_buffer*)(s), sizeof *(s) / sizeof(mcor_buffer))
/* Frees the buffers with which a struct begins, up to a member that is no buffer. */
#define MCOR_RELEASE_BEFORE(context, s, member)                                                    \
  mcor_release_each(context, (mcor_buffer*)(s),                                                    \
    (size_t)((char*)&(s)->member - (char*)(s)) / sizeof(mcor_buffer))
void mcor_release_each(mcor_context* context, mcor_buffer* buffers, size_t count);

/* mcor_ranks.c. Replace each value by its reduction over all ranks. Without ranks, values stay. */
mcor_status mcor_reduce_doubles(
  mcor_context* context, mcor_reduction reduction, double* values, int count);
mcor_status mcor_reduce_counts(
  mcor_context* context, mcor_reduction reduction, int64_t* values, int count);
/* Gathers the records of all ranks; they are valid until the next gathering. A single process gets
 * its own records. */
mcor_status mcor_gather_records(mcor_context* context, const void* records, int64_t count,
  size_t width, const void** all, int64_t* all_count);

/* mcor_statistics.c. Reports progress. doing: names the work that begins at `fraction` of the call
 * and goes on until `end`. The observer of progress may cancel the call. */
mcor_status mcor_report(mcor_context* context, const char* doing, double fraction, double end);
/* Reports a little more progress than the last report, if that report is old enough. To be called
 * between two launches, or between two steps of a loop of the host. */
mcor_status mcor_report_launch(mcor_context* context);
/* If the caller wants progress, the OpenCL layer calls this between launches (compiles: false), and
 * while programs are built (true). */
mcor_status mcor_observe_call(mcor_context* context, bool compiles);
/* Ends the current phase, begins the next one, and reports progress, which may cancel the call. */
mcor_status mcor_begin_phase(mcor_context* context, mcor_phase phase, double fraction, double end);
mcor_status mcor_finish_statistics(mcor_context* context);
double mcor_rounding(
  const mcor_context* context); /* the most by which positions on the device are rounded, along each axis */

/* mcor_reuse.c. mcor_check_reuse finds which results of the last call still hold.
 * mcor_same_particles tells by the caller's version number whether the particles are the same.
 * mcor_keep_call keeps what the next call compares: the input, the options and the globals. */
void mcor_check_reuse(mcor_context* context, const mcor_input* input, const mcor_options* options);
bool mcor_same_particles(const mcor_input* input, const mcor_input* last);
void mcor_keep_call(mcor_context* context, const mcor_input* input, const mcor_options* options);

/* mcor_check.c, mcor_measure.c */
mcor_status mcor_check_scalar_form(mcor_context* context, const mcor_input* input);
mcor_status mcor_check_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options);
mcor_status mcor_measure_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options);

/* mcor_measure_wall.c. Measures the wall share if the options ask for it and it is not yet
 * known. */
mcor_status mcor_measure_wall(mcor_context* context, const mcor_input* input);

/* mcor_scan.c */
mcor_status mcor_scan(mcor_context* context, mcor_buffer* counts, int count, int* total);
mcor_status mcor_count_bits(mcor_context* context, const mcor_buffer* masks,
  const mcor_buffer* within, int count, int* total);
mcor_status mcor_sort(
  mcor_context* context, mcor_buffer* keys, mcor_buffer* values, int count, uint64_t key_limit);
mcor_status mcor_list_runs(mcor_context* context, const mcor_buffer* keys, int count,
  mcor_buffer* distinct, mcor_buffer* begins, int* distinct_count);
uint64_t mcor_most_buckets(int keys);
mcor_status mcor_unique(mcor_context* context, mcor_buffer* keys, int count, uint64_t key_limit,
  mcor_buffer* distinct, mcor_buffer* index_of, int* distinct_count);
mcor_status mcor_index_keys(mcor_context* context, const mcor_buffer* keys, int count,
  uint64_t key_limit, mcor_buffer* buckets, int* shift);

/* mcor_box.c. Whether `sides` holds bounds; six zeros (0 or -0) mean none. */
bool mcor_has_sides(const double sides[6]);

/* mcor_extract.c. Whether the programs for a surface read solids. With globals, the solids of all
 * ranks decide, so that all ranks use the same programs. */
bool mcor_has_solids(const mcor_input* input, const mcor_options* options);
/* Returns the programs that a surface needs, as bits 1 << mcor_program. Call mcor_find_plane first:
 * the programs depend on whether the call is in a plane. */
int mcor_list_programs(const mcor_context* context, const mcor_input* input,
  const mcor_options* options, bool has_solids);

/* The phases of a call, and functions that several phases use. */
mcor_status mcor_make_grid(mcor_context* context, const mcor_input* input);
mcor_status mcor_set_scalar(mcor_context* context, const mcor_input* input);
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, bool fixed, mcor_buffer* to,
  int to_row);
void mcor_release_grid(mcor_context* context);
void mcor_release_brick_data(mcor_context* context, mcor_brick_data* data);
void mcor_release_nodes(mcor_context* context);
void mcor_release_attributes(mcor_context* context);
mcor_status mcor_make_blocks(mcor_context* context);
mcor_status mcor_select_seeds(mcor_context* context, const mcor_input* input);
/* Writes the cells between the particles of each pair to bricks.seeds. Writes these cells, and all
 * cells reached from them through faces that the surface crosses, to bricks.cells. Evaluates the
 * nodes of all these cells. */
mcor_status mcor_find_reached(mcor_context* context);
double mcor_side_margin(const mcor_context* context);
mcor_status mcor_place_bricks(mcor_context* context);
mcor_status mcor_find_neighbours(mcor_context* context);
mcor_status mcor_make_groups(
  mcor_context* context, const mcor_buffer* node, int first, int count, int* group_count);
mcor_status mcor_reserve_points(mcor_context* context, mcor_field_points* points, size_t count);
mcor_status mcor_evaluate_points(
  mcor_context* context, const mcor_field_points* points, int first, int count, int* group_count);
mcor_status mcor_group_batch(
  mcor_context* context, mcor_point_batch* batch, int count, int inside, int* group_count);
mcor_status mcor_evaluate_nodes(mcor_context* context);
mcor_status mcor_sign_nodes(mcor_context* context, const mcor_buffer* evaluated);
mcor_status mcor_march(mcor_context* context);
mcor_status mcor_resolve_topology(mcor_context* context);
mcor_status mcor_correct(mcor_context* context);
/* Evaluates the boundary eigenvalue at vertices. `vertices`: MCOR_ON_EDGES or MCOR_ALL_VERTICES,
 * see mcor_adaptive.h. */
mcor_status mcor_evaluate_boundary(mcor_context* context, int vertices, mcor_buffer* eigenvalue);
mcor_status mcor_trim(mcor_context* context);
/* mcor_is_trimmed: whether the mesh is trimmed. mcor_trims_by_eigenvalue: whether the vertex
 * threshold is for the boundary eigenvalue, not for the weight. mcor_trim_quantity returns the
 * quantity that trimming compares with mcor_trim_threshold, at the vertices on lattice edges. */
bool mcor_is_trimmed(const mcor_context* context);
bool mcor_trims_by_eigenvalue(const mcor_context* context);
const mcor_buffer* mcor_trim_quantity(const mcor_context* context);
double mcor_trim_threshold(const mcor_context* context);
/* Returns the index of the edge between vertices p and q in `cuts`, the host's copy of
 * mesh.cut_edges; -1: the edge is not cut. */
int mcor_find_cut(const cl_ulong* cuts, int count, int32_t p, int32_t q);
double mcor_least_fluid(const mcor_context* context); /* the least weight of the fluid itself at a vertex; 0: none is needed */
double mcor_vertex_threshold(const mcor_context* context);
mcor_status mcor_extend_vertices(mcor_context* context, int old, int count);
mcor_status mcor_list_components(
  mcor_context* context, const mcor_input* input, bool of_surface, int64_t* not_finite);
bool mcor_evaluate_without_scalar(const mcor_input* input, mcor_options* options);
mcor_status mcor_load_attributes(mcor_context* context, const mcor_input* input, int first);
mcor_status mcor_add_attributes(
  mcor_context* context, const mcor_input* input, const cl_int* scanned, mcor_surface* surface);
bool mcor_output_evaluates(const mcor_context* context);
/* Appends the mesh to the surface. all: also the vertices that no triangle uses. */
mcor_status mcor_append_output(
  mcor_context* context, const mcor_input* input, bool all, mcor_surface* surface);
/* mcor_surface.c. Prepares the surface's attributes: finds which attributes to leave out, and which
 * components of the remaining attributes vary. */
mcor_status mcor_begin_surface(
  mcor_context* context, const mcor_input* input, mcor_surface* surface);
/* The arrays of a surface's points except attributes, and their bytes per point. */
#define MCOR_SURFACE_ARRAYS 13
typedef struct mcor_surface_array
{
  void** array;
  size_t width;
} mcor_surface_array;
void mcor_list_surface_arrays(
  mcor_surface* surface, mcor_surface_array arrays[MCOR_SURFACE_ARRAYS]);
/* Makes room for `count` elements of `width` bytes behind the first `old` elements; *array may be
 * NULL. */
mcor_status mcor_grow(
  mcor_context* context, void** array, int64_t old, int64_t count, size_t width);
/* Makes room for `points` more points in all arrays of the surface that the caller wants. */
mcor_status mcor_grow_surface(
  mcor_context* context, const mcor_input* input, mcor_surface* surface, int64_t points);
static inline void mcor_move_triangle(mcor_surface* surface, int64_t from, int64_t to)
{
  memmove(surface->triangles + 3 * to, surface->triangles + 3 * from, 3 * sizeof(int32_t));
  if (surface->triangle_keys)
  {
    memmove(surface->triangle_keys + MCOR_TRIANGLE_KEY * to,
      surface->triangle_keys + MCOR_TRIANGLE_KEY * from, MCOR_TRIANGLE_KEY * sizeof(uint64_t));
  }
}

/* Return the key of a brick, and of a node. rung: the rung of the brick's level. node: x, y, z, and
 * level << MCOR_LEVEL_SHIFT. Keys are in the order of slots and vertices: by level, then by block,
 * brick and node, each of these by z, then y, then x. A cell has the key of its lowest node. */
static inline uint64_t mcor_brick_key(const mcor_rung* rung, const int brick[3])
{
  uint64_t block = 0, number = 0;
  for (int a = 2; a >= 0; --a)
  {
    block = block * (uint64_t)rung->n[a] + (uint64_t)(brick[a] >> 3);
    number = number << 3 | (uint64_t)(brick[a] & 7);
  }
  return (rung->base + block) * MCOR_BLOCK_BRICKS + number;
}
static inline uint64_t mcor_node_key(const mcor_lattice* lattice, const cl_int node[4])
{
  const int brick[3] = { node[0] / MCOR_BRICK, node[1] / MCOR_BRICK, node[2] / MCOR_BRICK };
  const int inner = node[0] % MCOR_BRICK + MCOR_BRICK * (node[1] % MCOR_BRICK) +
    MCOR_BRICK * MCOR_BRICK * (node[2] % MCOR_BRICK);
  const mcor_rung* rung = &lattice->rungs[node[3] >> MCOR_LEVEL_SHIFT];
  return mcor_brick_key(rung, brick) << 6 | (uint64_t)inner;
}
/* mcor_area.c. Whether a point has no normal, because the gradient there is 0. mcor_finish_normals
 * makes normals for such points. */
static inline bool mcor_lacks_normal(const float normal[3])
{
  return normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
}
mcor_status mcor_finish_normals(mcor_context* context, mcor_surface* surface);
/* Measures a surface of triangles: writes is_closed, area and volume to its statistics. Does
 * nothing for lines. */
mcor_status mcor_measure_surface(mcor_context* context, mcor_surface* surface);

/* The cases of Marching Cubes, with all decisions on their ambiguous faces. */
#define MCOR_CASE_ROWS 1200
typedef struct mcor_case_table
{
  /* For each case: its first row << 6 | its ambiguous faces, as bits 2 axis + side. A case's rows
   * are numbered from 0. If bit i of a row's number is set, the corners above the iso value are
   * joined on the i-th ambiguous face. Rows with tunnels come last. */
  cl_int cases[256];
  int row_count;
  mcor_cell_row rows[MCOR_CASE_ROWS];
} mcor_case_table;

void mcor_make_case_table(mcor_case_table* table);
/* Uploads the table unless it is on the device. */
mcor_status mcor_upload_case_table(mcor_context* context);

/* Arguments of MCOR_ATTRIBUTE_PARAMS. */
#define MCOR_ATTRIBUTE_ARGS(c, means)                                                              \
  MCOR_INT((c)->attributes.count), MCOR_INT((c)->grid.count),                                      \
    MCOR_BUFFER(&(c)->attributes.sorted), MCOR_BUFFER(means)

/* Returns the length, in cubes, of the virtual grid's edges along an axis; the device holds this
 * number exactly. */
static inline double mcor_edge_of(const mcor_lattice* lattice, int axis)
{
  return ldexp((double)lattice->step[axis], -lattice->fix_bits);
}

#define MCOR_EDGE_ARGS(c)                                                                          \
  MCOR_REAL(mcor_edge_of(&(c)->lattice, 0)), MCOR_REAL(mcor_edge_of(&(c)->lattice, 1)),            \
    MCOR_REAL(mcor_edge_of(&(c)->lattice, 2))

/* Returns the buffer for the weights of fluid particles. */
static inline const mcor_buffer* mcor_fluid_weight(const mcor_grid* grid)
{
  return grid->has_solids ? &grid->fluid_weight : &grid->trim_weight;
}

/* Kernel arguments of MCOR_GRID_PARAMS, MCOR_BLOCK_PARAMS and MCOR_BRICK_PARAMS. weight: the
 * buffer whose weights are summed, of fluid particles or of all. */
#define MCOR_GRID_ARGS(c) MCOR_WEIGHTED_GRID_ARGS(c, mcor_fluid_weight(&(c)->grid))
#define MCOR_WEIGHTED_GRID_ARGS(c, weight)                                                         \
  MCOR_INT((c)->grid.count), MCOR_INT((c)->grid.level_count), MCOR_INT((c)->grid.bucket_shift),    \
    MCOR_REAL(ldexp(1, -(c)->lattice.fix_bits - (c)->grid.view)),                                  \
    MCOR_REAL(ldexp(1, (c)->lattice.fix_bits + (c)->grid.view)),                                   \
    MCOR_REAL(ldexp(1, (c)->grid.view)), MCOR_EDGE_ARGS(c), MCOR_BUFFER(&(c)->grid.level_buffer),  \
    MCOR_BUFFER(&(c)->grid.buckets), MCOR_BUFFER(&(c)->grid.cell_keys),                            \
    MCOR_BUFFER(&(c)->grid.cell_begins), MCOR_BUFFER(&(c)->grid.px), MCOR_BUFFER(&(c)->grid.py),   \
    MCOR_BUFFER(&(c)->grid.pz), MCOR_BUFFER(&(c)->grid.inv_h), MCOR_BUFFER(weight),                \
    MCOR_BUFFER(&(c)->grid.trim_weight), MCOR_BUFFER(&(c)->grid.value)

/* Kernel arguments of MCOR_SEED_PARAMS. */
#define MCOR_SEED_ARGS(c)                                                                          \
  MCOR_BUFFER(&(c)->grid.side_flags), MCOR_REAL(mcor_side_margin(c)),                              \
    MCOR_REAL((c)->run.iso.relative), MCOR_REAL((c)->run.options->node_threshold)

#define MCOR_BLOCK_ARGS(c)                                                                         \
  MCOR_INT((c)->bricks.block_count), MCOR_INT((c)->bricks.block_shift),                            \
    MCOR_BUFFER(&(c)->bricks.rungs), MCOR_BUFFER(&(c)->bricks.block_keys),                         \
    MCOR_BUFFER(&(c)->bricks.block_buckets)

#define MCOR_BRICK_ARGS(c)                                                                         \
  MCOR_BLOCK_ARGS(c), MCOR_BUFFER(&(c)->bricks.bits), MCOR_BUFFER(&(c)->bricks.base)

static inline bool mcor_is_resolved(const mcor_context* context)
{
  return context->run.options->topology == MCOR_TOPOLOGY_FIELD;
}

/* Kernel arguments of MCOR_CUT_PARAMS. */
#define MCOR_CUT_ARGS(c)                                                                           \
  MCOR_INT(mcor_is_resolved(c)), MCOR_BUFFER(&(c)->bricks.neighbours),                             \
    MCOR_BUFFER(&(c)->topology.decisions), MCOR_BUFFER(&(c)->cases), MCOR_BUFFER(&(c)->case_rows)

#endif
