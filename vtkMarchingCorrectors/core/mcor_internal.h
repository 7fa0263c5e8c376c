/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_internal_h
#define mcor_internal_h

/* State shared by the phases. Each phase is one file of the same name as its kernels. */

#include "mcor_cl.h"
#include "mcor_parts.h"
#include "mcor_shared.h"

#include <math.h>

#define MCOR_LEVEL_LIMIT 32

/* Highest level of adaptive cubes. */
#define MCOR_TREE_LEVEL_LIMIT 24

#define MCOR_TRY(call)                                                                             \
  do                                                                                               \
  {                                                                                                \
    const mcor_status mcor_try_status_ = (call);                                                   \
    if (mcor_try_status_ != MCOR_OK)                                                               \
    {                                                                                              \
      return mcor_try_status_;                                                                     \
    }                                                                                              \
  } while (0)

/* Returns with a status and the sentence that explains it. */
#define MCOR_RETURN_IF(condition, context, status, ...)                                            \
  do                                                                                               \
  {                                                                                                \
    if (condition)                                                                                 \
    {                                                                                              \
      return mcor_fail(context, status, __VA_ARGS__);                                              \
    }                                                                                              \
  } while (0)

/* The virtual grid: world position = (origin + fixed / step) * edge, along each axis. Lengths on the device
 * are in cubes, 2^fix_bits fixed-point units. An edge is a cube long, but where no cube divides all periods:
 * then a cube, as a length, is a little longer than any edge, see mcor_fit_steps. */
typedef struct mcor_lattice
{
  double cube, edge[3];
  int64_t step[3];           /* an edge in fixed-point units, at most 2^fix_bits */
  int64_t origin[3];         /* a multiple of MCOR_BLOCK_CUBES */
  int64_t first[3], last[3]; /* nodes that a particle's support may reach, from origin */
  int fix_bits;
  int top; /* highest level of adaptive cubes; 0: uniform */
  int blocks[3];
  int period[3], period_first[3]; /* cells, 0: open; where one begins, from origin */
} mcor_lattice;

/* On the way to the search grid. */
typedef struct mcor_stage_data
{
  mcor_buffer x, y, z, inv_h, size, level; /* of the particles in the order of the input */
  mcor_buffer values;                      /* real, of one component, in that order */
  mcor_buffer density;                     /* where volumes are computed */
  mcor_buffer flags, keys;                 /* of coincident particles */
  mcor_buffer found;                       /* int: what a kernel found in any of them */
} mcor_stage_data;

/* [III-A] */
typedef struct mcor_grid
{
  int count; /* particles on the device */
  int level_count, bucket_shift;
  mcor_level levels[MCOR_LEVEL_LIMIT];
  mcor_buffer level_buffer, buckets, cell_keys, order;
  mcor_buffer px, py, pz, inv_h, trim_weight, fluid_weight; /* fluid_weight: with solids only */
  mcor_buffer value;
  /* As seen from a level of adaptive cubes, in its cells' edges; see mcor_view_level. */
  int view;
  mcor_buffer view_levels, view_inv_h;
  int most_in_cell;       /* particles, at least MCOR_USUAL_IN_CELL */
  mcor_buffer side_flags; /* uchar per chunk of particles, of this iso value; see mcor_seed.cl */
  bool has_solids;
} mcor_grid;

/* What is known of the bricks that exist. */
typedef struct mcor_brick_data
{
  int count;
  mcor_buffer bricks;        /* int4: position in bricks */
  mcor_buffer known;         /* ulong: nodes evaluated, all or none of a brick */
  mcor_buffer cells;         /* ulong: cells to examine for this iso value */
  mcor_buffer examined;      /* ulong: those whose nodes have been asked for */
  mcor_buffer value, weight; /* real [64] */
  mcor_buffer above, valid;  /* ulong: signs of the known nodes, see mcor_node_signs */
} mcor_brick_data;

/* [III-B] Blocks where there may be surface, and the bricks that exist in them. */
typedef struct mcor_bricks
{
  int block_count, block_shift;
  mcor_buffer block_keys, block_buckets;
  mcor_buffer block_states, inactive; /* uchar; see mcor_block.cl */
  mcor_buffer states;                 /* uchar [block_count][512], see mcor_seed.cl */
  mcor_buffer bits, base;             /* [block_count][16] */
  mcor_buffer seed_bits, seeds; /* of complete seeds: bricks as in bits; ulong, cells by slot */
  mcor_brick_data now;
  mcor_buffer neighbours; /* see mcor_brick_neighbours */
  bool neighbours_valid;
  mcor_buffer placed, slot_of;                       /* of mcor_append_bricks, see mcor_brick.cl */
  mcor_buffer need, fresh;                           /* fresh: see mcor_march_need */
  mcor_buffer bit_counts;                            /* of mcor_count_bits */
  mcor_buffer child_counts, child_keys, child_index; /* while cubes are divided */
  mcor_buffer regions;                               /* int: those to examine */
  mcor_buffer pair_cells; /* ulong [block_count][512]: cells between pairs */
  mcor_buffer found;      /* int: what a kernel found in any brick, or how many regions */
} mcor_bricks;

/* [III-D] One iso value's surface while it is made. */
typedef struct mcor_mesh
{
  mcor_buffer used, edges, vertex_base, triangle_base;
  int march_count;  /* vertices on lattice edges; sorted by level, as are those of the boundary */
  int vertex_count; /* the same, those of the trim boundary, and from cap_first on those of caps */
  int cap_first;
  uint64_t* cap_keys; /* on the host: two numbers for each vertex of a cap, see mcor_cap.c */
  int triangle_count;
  mcor_buffer node, ends, offset, linear, field_value, gradient, vertex_weight, flag, evaluations;
  mcor_buffer means; /* real [vertex_count][attributes.count] */
  mcor_buffer triangles;
  mcor_buffer scanned;                           /* of the output, see mcor_is_output */
  int level_first[2][MCOR_TREE_LEVEL_LIMIT + 2]; /* first of each level; of the boundary's */
} mcor_mesh;

/* Some of 4^3 bricks of adaptive cubes, aligned to multiples of 4: bit x + 4 y + 16 z. */
typedef struct mcor_cluster
{
  uint64_t key; /* its number in its level, see mcor_cluster_key */
  uint64_t bricks;
} mcor_cluster;

/* A set of bricks of one level. */
typedef struct mcor_brick_set
{
  mcor_cluster* slots;    /* [capacity]; one without bricks is free */
  size_t capacity;        /* a power of 2, or 0 */
  size_t clusters, count; /* of bricks */
} mcor_brick_set;

/* Leaves of adaptive cubes; see mcor_tree.h. */
typedef struct mcor_tree
{
  int top;                                    /* highest level of leaves */
  bool is_plane;                              /* all bricks are of the lowest layer */
  int period[3], period_first[3];             /* as in mcor_lattice */
  mcor_rung rungs[MCOR_TREE_LEVEL_LIMIT + 2]; /* up to one above */
  uint64_t key_limit;
  mcor_brick_set split[MCOR_TREE_LEVEL_LIMIT + 2];
  cl_int* leaves; /* [leaf_count][4]: brick of its level, level; by level, else in no order */
  cl_uint* finer; /* [leaf_count]: what is finer around each, see MCOR_DIRECTION */
  int leaf_count, first_leaf[MCOR_TREE_LEVEL_LIMIT + 2];
  /* Leaves that are parts of one brick follow each other: first of each such region. */
  cl_int* regions; /* [region_count + 1] */
  int region_count, first_region[MCOR_TREE_LEVEL_LIMIT + 2];
} mcor_tree;

/* Marching of leaves; see mcor_adaptive.c. Slots are those of mcor_brick_data. */
typedef struct mcor_adaptive
{
  int count;                                 /* leaves where there may be surface */
  int first_leaf[MCOR_TREE_LEVEL_LIMIT + 2]; /* of them, of each level */
  int first_slot[MCOR_TREE_LEVEL_LIMIT + 2];
  int evaluated, dropped; /* nodes along with states; of these, those that got no slot */
  mcor_buffer rungs;      /* mcor_rung, of all levels of leaves */
  mcor_buffer leaves, leaf_finer, regions; /* int4, uint, int: of the tree */
  mcor_buffer region_keys, region_order;   /* ulong, sorted; int: whose each is */
  mcor_buffer states, chosen;              /* int, uchar: of all leaves */
  mcor_buffer proofs, mixed;           /* uchar: of slots; of leaves where there may be surface */
  mcor_buffer cells;                   /* int4: those where there may be surface, in order */
  mcor_buffer finer;                   /* uint: where their neighbours are finer */
  mcor_buffer wanted, requests, index; /* keys of bricks with nodes of theirs */
  mcor_buffer keys, buckets;           /* of slots */
  int bucket_shift;
  mcor_buffer tables;    /* int [MCOR_LEAF_SLOTS]: slots of their nodes */
  mcor_buffer quadrants; /* uint [MCOR_QUADRANT_WORDS], of a slot's edges */
  mcor_buffer flat;      /* int, of each leaf, scanned */
  mcor_buffer seeds;     /* ulong: cells that are counted as seeds */
} mcor_adaptive;

/* Of adaptive cubes, which cells pairs reach; see mcor_adaptive_pair.c. Masks are of the leaves where there
 * may be surface. */
typedef struct mcor_adaptive_pairs
{
  int place_count;
  mcor_buffer place_keys, place_leaves; /* ulong, sorted; int */
  mcor_buffer seeds, reached, grown;    /* ulong: marked by pairs; by now; when last looked at */
  mcor_buffer domain;                   /* ulong: where growth may go */
  mcor_buffer heard;                    /* int4: cells that other boxes have reached */
  mcor_buffer found;                    /* int: what a kernel found in any leaf */
} mcor_adaptive_pairs;

/* Of MCOR_TOPOLOGY_FIELD. */
typedef struct mcor_topology_data
{
  mcor_buffer cases, rows; /* mcor_topology_table; empty until first used */
  mcor_buffer decisions;   /* see MCOR_DECISION_MASKS */
  mcor_buffer counts, sample_base, sample_node, sample_offset, sample_side;
  mcor_buffer plain, used; /* ulong: of adaptive cubes, see mcor_adaptive_topology.c */
} mcor_topology_data;

/* Points at which the field is evaluated, see mcor_make_groups. */
typedef struct mcor_points
{
  mcor_buffer flags, groups;
} mcor_points;

/* Points that are evaluated in sorted order, as nodes and offsets; in_: as they came. */
typedef struct mcor_point_batch
{
  mcor_buffer keys, order, in_node, in_offset, node, offset;
  cl_int first[3], bricks[3]; /* the bricks that its points are in: fewer make shorter keys */
} mcor_point_batch;

/* [III-D.3] */
typedef struct mcor_trim_data
{
  mcor_buffer eigenvalue;            /* real, at vertices; what the vertex threshold may apply to */
  mcor_buffer margin;                /* real, at vertices; see mcor_trim_margin */
  mcor_buffer remaining, cuts;       /* per batch of triangles */
  mcor_buffer keys, distinct, index; /* of cut edges */
  mcor_buffer triangles;
} mcor_trim_data;

/* mcor_scan.c. flags and order: of mcor_unique. */
typedef struct mcor_sort_data
{
  mcor_buffer sums, keys, values, histogram, order, flags;
} mcor_sort_data;

/* One component of an attribute. */
typedef struct mcor_component
{
  int attribute, component;
  double shift, scale; /* on the device: (value - shift) * scale */
  double low, high;    /* of a probe's, over fluid particles: no mean of theirs is beyond */
} mcor_component;

/* The components that vary, and those of them that are on the device. */
typedef struct mcor_attributes
{
  mcor_component* varying; /* [varying_count] */
  int varying_count;
  int first, count;
  mcor_buffer sorted; /* real [count][grid.count] */
  uint64_t kept; /* attributes_version of a probe, where all of it holds for the next one; or 0 */
  mcor_buffer nearest; /* int, particle per vertex */
} mcor_attributes;

/* Who counts a vertex; 0: nobody. */
enum
{
  MCOR_OWN = 1,
  MCOR_ANOTHERS = 2 /* another rank */
};

/* The cells that a call owns; see mcor_box.c. */
typedef struct mcor_box
{
  bool is_part, is_empty; /* not all cells of the lattice are owned; none is */
  int first[3], last[3];  /* owned cells [first, last), from the lattice's origin */
  int halves[6];          /* of adaptive cubes: x, y, z from, to, in halves of the smallest ones */
  int near[6];            /* the same of those whose particles are on the device */
  bool of_points;         /* of a probe's points, which lie in `points`: x from, to, y ... */
  double points[6];
  int begin[3], end[3]; /* the same of those whose particles are on the device */
  int whole_first[3], whole_last[3], whole_halves[6]; /* cells that any rank owns */
  mcor_buffer cells;   /* ulong per triangle of the mesh, see mcor_triangle_cell.c */
  mcor_buffer clipped; /* ulong per brick, of mcor_count_cells */
  uint8_t* kept;       /* per triangle of the surface: 1 of an owned cell; NULL: all are */
  cl_ulong* told;      /* per brick or leaf, cells that others know of; see mcor_pair_rounds.c */
  int told_count;
} mcor_box;

/* The call under way; options are NULL between calls. */
typedef struct mcor_run
{
  const mcor_options* options;
  struct mcor_filling* fill; /* of iso values that are done, see mcor_fill.h; NULL */
  mcor_statistics* statistics;
  int iso_number; /* of the iso value under way */
  mcor_phase phase;
  double phase_begin;
  const char* doing;             /* what runs, as last reported */
  double fraction, fraction_end; /* last reported, also by a first attempt; where what runs ends */
  double report_time;            /* of the last report */
  bool building_told;            /* in this phase */
  double correction_count, correction_sum, correction_squares;
  int64_t evaluations_counted; /* of vertices_corrected */
} mcor_run;

/* The data set of the last call, and which of its results hold; see mcor_reuse.c. */
typedef struct mcor_kept
{
  mcor_input input;
  mcor_options options;
  mcor_globals globals; /* given; 0 where none were; its arrays are not kept */
  uint64_t splits;      /* of their split bricks, a hash */
  bool uses_solids;     /* solid particles are on the device */
  bool grid, value;
  bool nodes; /* bricks hold node values of the current scalar */
} mcor_kept;

struct mcor_context
{
  bool created; /* false: mcor_create_context failed */
  char error[4096];
  mcor_run run;

  /* The device, and what is on it whatever the data. */
  mcor_cl cl;
  mcor_buffer case_table;
  mcor_sort_data sort;
  double report_interval; /* between launches, seconds; at least that */
  int probe_batch;        /* points; 0 before the first probe */

  /* The data set. */
  mcor_kept kept;
  mcor_measure measure;
  mcor_lattice lattice;
  mcor_plane plane; /* of the call under way */
  mcor_box box;
  mcor_stage_data stage;
  mcor_grid grid;
  int32_t* source;       /* [grid.count] input index of each device particle; NULL: the same */
  double value_shift;    /* A0 */
  double largest_weight; /* no particle has a greater V / (scaled h)^3 */
  mcor_attributes attributes;
  mcor_tree tree;

  /* The surface of one iso value. */
  mcor_bricks bricks;
  mcor_adaptive adaptive;
  mcor_adaptive_pairs adaptive_pairs;
  mcor_topology_data topology;
  mcor_mesh mesh;
  mcor_points points;
  mcor_trim_data trim;
};

mcor_status mcor_fail(mcor_context* context, mcor_status status, const char* format, ...)
#if defined(__GNUC__)
  __attribute__((format(printf, 3, 4)))
#endif
  ;
double mcor_seconds(void);
/* Of a kernel with W = norm / h^3 w(q). */
double mcor_kernel_norm(mcor_sph_kernel kernel);

/* mcor_pages.c. Before an array of the host, or of a device that shares its memory, is touched. */
#define MCOR_LARGE_ARRAY ((size_t)4 << 20)
void mcor_use_large_pages(void* memory, size_t bytes);

/* Element i of an array of the device's real type. */
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

/* As the device has it. */
static inline double mcor_real_of(const mcor_context* context, double value)
{
  return context->cl.real_size == sizeof(float) ? (double)(float)value : value;
}

/* Elements that kernels count: rounded up to any work-group or batch, it still is an int. */
#define MCOR_COUNT_LIMIT (INT32_MAX - 4095)
/* Lattice nodes along one axis at most: then single precision fixed point keeps 2^-9 cubes. */
#define MCOR_LATTICE_LIMIT (1 << 20)

/* Whether vertex v is put out, being used by a triangle: as point scanned[v] of its mesh. */
static inline bool mcor_is_output(const cl_int* scanned, int64_t v)
{
  return scanned[v] != scanned[v + 1];
}

/* Input index of particle i of the device. */
static inline int64_t mcor_source_of(const mcor_context* context, int64_t i)
{
  return context->source ? context->source[i] : i;
}

/* Batches of so many particles or triangles, above 0. */
static inline int mcor_batches(const mcor_context* context, int count)
{
  return (count - 1) / MCOR_BATCH_OF(context->cl.lanes) + 1;
}

/* The wall share that is asked for. */
static inline double mcor_asked_share(const mcor_options* options)
{
  return options->wall_share != MCOR_WALL_SHARE_AUTO ? options->wall_share
    : options->field == MCOR_WEIGHT_SUM              ? 0
                                                     : MCOR_WALL_SHARE_MEASURED;
}

/* The free surface needs solids only to end at them. */
static inline bool mcor_uses_solids(const mcor_input* input, const mcor_options* options)
{
  return !input->ignore_solids &&
    (options->field != MCOR_WEIGHT_SUM || mcor_asked_share(options) != 0);
}

/* The wall share in use. */
static inline double mcor_wall_share(const mcor_context* context)
{
  const double share = mcor_asked_share(context->run.options);
  return share < 0 ? context->measure.wall_share : share;
}

/* Whether seeds are the paper's pairs. The free surface has no values that pairs could straddle. */
static inline bool mcor_wants_pairs(const mcor_options* options)
{
  return options->seeds == MCOR_PAIRS && options->field != MCOR_WEIGHT_SUM;
}

static inline bool mcor_uses_pairs(const mcor_context* context)
{
  return mcor_wants_pairs(context->run.options);
}

/* The work of one call; what an attempt before left in the result is to be freed first. */
typedef mcor_status (*mcor_body)(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* result);

/* Runs the body, and once more where memory ran out but some could be given back. */
mcor_status mcor_run_call(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_statistics* statistics, mcor_body body, void* result);
/* Before a call: where no device was named and this one cannot do the build, another one is opened. */
mcor_status mcor_settle_device(mcor_context* context, const mcor_build* build);
mcor_status mcor_prepare(
  mcor_context* context, const mcor_input* input, const mcor_options* options, bool uses_solids);

/* Gives back buffers; those that are empty stay so. */
#define MCOR_RELEASE(context, ...)                                                                 \
  mcor_release_all(context, (mcor_buffer* const[]){ __VA_ARGS__ },                                 \
    sizeof((mcor_buffer* const[]){ __VA_ARGS__ }) / sizeof(mcor_buffer*))
void mcor_release_all(mcor_context* context, mcor_buffer* const buffers[], size_t count);

/* Reports that something runs from one fraction of the call to another; may cancel. */
mcor_status mcor_report(mcor_context* context, const char* doing, double fraction, double end);
/* The same between two launches, or steps of a loop of the host: where it is time for a sign of life, a bit
 * nearer to the end. */
mcor_status mcor_report_launch(mcor_context* context);
/* Ends the phase under way, reports progress and may cancel. */
mcor_status mcor_begin_phase(mcor_context* context, mcor_phase phase, double fraction, double end);
mcor_status mcor_finish_statistics(mcor_context* context);

/* mcor_reuse.c. What of the last call still holds; whether the caller's version stands for the same
 * particles as then. */
void mcor_check_reuse(
  mcor_context* context, const mcor_input* input, const mcor_options* options, bool uses_solids);
bool mcor_same_particles(const mcor_input* input, const mcor_input* last);
void mcor_keep_call(mcor_context* context, const mcor_input* input, const mcor_options* options);

/* mcor_check.c, mcor_measure.c */
mcor_status mcor_check_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options);
mcor_status mcor_measure_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options);

/* mcor_measure_wall.c. The wall share, where the options ask for it and it is not yet measured. */
mcor_status mcor_measure_wall(mcor_context* context, const mcor_input* input);

/* mcor_scan.c */
mcor_status mcor_scan(mcor_context* context, mcor_buffer* counts, int count, int* total);
mcor_status mcor_sort(
  mcor_context* context, mcor_buffer* keys, mcor_buffer* values, int count, uint64_t key_limit);
void mcor_release_sort(mcor_context* context);
mcor_status mcor_unique(mcor_context* context, mcor_buffer* keys, int count, uint64_t key_limit,
  mcor_buffer* distinct, mcor_buffer* index_of, int* distinct_count);
mcor_status mcor_index_keys(mcor_context* context, const mcor_buffer* keys, int count,
  uint64_t key_limit, mcor_buffer* buckets, int* shift);

/* The phases. */
mcor_status mcor_make_grid(mcor_context* context, const mcor_input* input);
mcor_status mcor_set_scalar(mcor_context* context, const mcor_input* input);
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, mcor_buffer* to, int to_row);
void mcor_release_stage(mcor_context* context);
void mcor_release_grid(mcor_context* context);
void mcor_release_brick_data(mcor_context* context, mcor_brick_data* data);
void mcor_release_bricks(mcor_context* context);
void mcor_release_nodes(mcor_context* context);
void mcor_release_points(mcor_context* context);
void mcor_release_mesh(mcor_context* context);
void mcor_release_topology(mcor_context* context);
void mcor_release_trim(mcor_context* context);
void mcor_release_attributes(mcor_context* context);
mcor_status mcor_make_blocks(mcor_context* context, double iso);
mcor_status mcor_request_known(mcor_context* context);
mcor_status mcor_select_seeds(mcor_context* context, double iso);
double mcor_side_margin(const mcor_context* context);
mcor_status mcor_grow_bricks(mcor_context* context, bool* grown);
mcor_status mcor_seed_pairs(mcor_context* context, double iso);
mcor_status mcor_place_bricks(mcor_context* context);
mcor_status mcor_find_neighbours(mcor_context* context);
mcor_status mcor_append_bricks(mcor_context* context);
mcor_status mcor_make_groups(
  mcor_context* context, const mcor_buffer* node, int first, int count, int* group_count);
mcor_status mcor_group_batch(
  mcor_context* context, mcor_point_batch* batch, int count, int inside, int* group_count);
void mcor_release_batch(mcor_context* context, mcor_point_batch* batch);
mcor_status mcor_reserve_vertices(mcor_context* context, int count);
mcor_status mcor_count_bits(mcor_context* context, const mcor_buffer* masks,
  const mcor_buffer* within, int count, int* total);
mcor_status mcor_evaluate_nodes(mcor_context* context);
mcor_status mcor_sign_nodes(mcor_context* context, double iso, const mcor_buffer* evaluated);
mcor_status mcor_march(mcor_context* context, double iso);
mcor_status mcor_find_side_flags(mcor_context* context, double iso);
mcor_status mcor_begin_topology(mcor_context* context);
mcor_status mcor_decide_topology(mcor_context* context, const mcor_buffer* used, double iso);
mcor_status mcor_resolve_topology(mcor_context* context, double iso);
/* Room for the vertices and triangles that are counted; the vertices. */
mcor_status mcor_emit_vertices(mcor_context* context, double iso);
mcor_status mcor_correct(mcor_context* context, double iso);
mcor_status mcor_evaluate_boundary(
  mcor_context* context, bool of_boundary, mcor_buffer* eigenvalue);
mcor_status mcor_trim(mcor_context* context, double iso);
/* What is trimmed by, at the vertices on lattice edges, and where it ends. */
bool mcor_is_trimmed(const mcor_context* context);
bool mcor_trims_by_eigenvalue(const mcor_context* context);
double mcor_fluid_share(const mcor_context* context);
const mcor_buffer* mcor_trim_quantity(const mcor_context* context);
double mcor_trim_threshold(const mcor_context* context);
double mcor_least_fluid(const mcor_context* context); /* of a vertex; 0: none is needed */
double mcor_vertex_threshold(const mcor_context* context);
mcor_status mcor_extend_vertices(mcor_context* context, int old, int count);
mcor_status mcor_list_attributes(
  mcor_context* context, const mcor_input* input, mcor_surface* surface);
mcor_status mcor_list_components(
  mcor_context* context, const mcor_input* input, int64_t* not_finite);
bool mcor_evaluate_without_scalar(const mcor_input* input, mcor_options* options);
bool mcor_attributes_remain(const mcor_context* context);
mcor_status mcor_load_attributes(mcor_context* context, const mcor_input* input, int first);
mcor_status mcor_add_attributes(
  mcor_context* context, const mcor_input* input, const cl_int* scanned, mcor_surface* surface);
bool mcor_output_evaluates(const mcor_context* context);
mcor_status mcor_append_output(
  mcor_context* context, const mcor_input* input, double iso, mcor_surface* surface);
/* All vertices of a mesh without triangles. */
mcor_status mcor_append_points(
  mcor_context* context, const mcor_input* input, mcor_surface* surface);
/* The optional and other arrays of a surface's points but the attributes, and bytes per point. */
#define MCOR_SURFACE_ARRAYS 11
typedef struct mcor_surface_array
{
  void** array;
  size_t width;
} mcor_surface_array;
void mcor_list_surface_arrays(
  mcor_surface* surface, mcor_surface_array arrays[MCOR_SURFACE_ARRAYS]);
/* mcor_point_key.c */
mcor_status mcor_keep_cuts(mcor_context* context, uint64_t** cuts);
/* In the order of vertices: by block, brick and node, each by z, y, x. Fits 2^61, as the lattice has no more
 * than 2^15 + 2 blocks along an axis. Of a cell's lowest node it is the cell's key. */
uint64_t mcor_node_key(const mcor_lattice* lattice, const cl_int node[4]);
void mcor_store_point_key(const mcor_context* context, const cl_int* nodes, const uint64_t* cuts,
  int64_t v, uint64_t key[MCOR_POINT_KEY]);
mcor_status mcor_finish_normals(mcor_context* context, mcor_surface* surface);
/* mcor_area.c. Into its statistics. */
mcor_status mcor_measure_surface(mcor_context* context, mcor_surface* surface);

/* 256 rows of 16: up to 15 edges, 3 a triangle, see mcor_cell_row; then the number of triangles. */
void mcor_make_case_table(uint8_t table[256][16]);

#define MCOR_TOPOLOGY_ROWS 1200
typedef struct mcor_topology_table
{
  /* First row << 6 | ambiguous faces, bit axis * 2 + side. Bit i of a row's number from there:
   * whether the corners above are joined on the i-th ambiguous face. Rows with tunnels come
   * last. */
  cl_int cases[256];
  int row_count;
  mcor_cell_row rows[MCOR_TOPOLOGY_ROWS];
} mcor_topology_table;

void mcor_make_topology_table(mcor_topology_table* table);

/* Arguments of MCOR_ATTRIBUTE_PARAMS. */
#define MCOR_ATTRIBUTE_ARGS(c, means)                                                              \
  MCOR_INT((c)->attributes.count), MCOR_INT((c)->grid.count),                                      \
    MCOR_BUFFER(&(c)->attributes.sorted), MCOR_BUFFER(means)

/* An edge of the virtual grid in cubes: exactly, as a number of the device. */
static inline double mcor_edge_of(const mcor_lattice* lattice, int axis)
{
  return ldexp((double)lattice->step[axis], -lattice->fix_bits);
}

#define MCOR_EDGE_ARGS(c)                                                                          \
  MCOR_REAL(mcor_edge_of(&(c)->lattice, 0)), MCOR_REAL(mcor_edge_of(&(c)->lattice, 1)),            \
    MCOR_REAL(mcor_edge_of(&(c)->lattice, 2))

/* Kernel arguments of MCOR_GRID_PARAMS, MCOR_BLOCK_PARAMS and MCOR_BRICK_PARAMS. */
#define MCOR_GRID_ARGS(c)                                                                          \
  MCOR_INT((c)->grid.count), MCOR_INT((c)->grid.level_count), MCOR_INT((c)->grid.bucket_shift),    \
    MCOR_INT((c)->lattice.fix_bits + (c)->grid.view), MCOR_EDGE_ARGS(c),                           \
    MCOR_BUFFER((c)->grid.view > 0 ? &(c)->grid.view_levels : &(c)->grid.level_buffer),            \
    MCOR_BUFFER(&(c)->grid.buckets), MCOR_BUFFER(&(c)->grid.cell_keys),                            \
    MCOR_BUFFER(&(c)->grid.px), MCOR_BUFFER(&(c)->grid.py), MCOR_BUFFER(&(c)->grid.pz),            \
    MCOR_BUFFER((c)->grid.view > 0 ? &(c)->grid.view_inv_h : &(c)->grid.inv_h),                    \
    MCOR_BUFFER((c)->grid.has_solids ? &(c)->grid.fluid_weight : &(c)->grid.trim_weight),          \
    MCOR_BUFFER(&(c)->grid.trim_weight), MCOR_BUFFER(&(c)->grid.value)

/* Kernel arguments of MCOR_SEED_PARAMS. */
#define MCOR_SEED_ARGS(c, iso)                                                                     \
  MCOR_BUFFER(&(c)->grid.side_flags), MCOR_REAL(mcor_side_margin(c)), MCOR_REAL(iso),              \
    MCOR_REAL((c)->run.options->node_threshold)

#define MCOR_BLOCK_ARGS(c)                                                                         \
  MCOR_INT((c)->bricks.block_count), MCOR_INT((c)->bricks.block_shift),                            \
    MCOR_INT((c)->lattice.blocks[0]), MCOR_INT((c)->lattice.blocks[1]),                            \
    MCOR_INT((c)->lattice.blocks[2]), MCOR_BUFFER(&(c)->bricks.block_keys),                        \
    MCOR_BUFFER(&(c)->bricks.block_buckets)

#define MCOR_BRICK_ARGS(c)                                                                         \
  MCOR_BLOCK_ARGS(c), MCOR_BUFFER(&(c)->bricks.bits), MCOR_BUFFER(&(c)->bricks.base)

static inline bool mcor_is_resolved(const mcor_context* context)
{
  return context->run.options->topology == MCOR_TOPOLOGY_FIELD;
}

/* Kernel arguments of MCOR_DECISION_PARAMS. */
#define MCOR_DECISION_ARGS(c)                                                                      \
  MCOR_INT(mcor_is_resolved(c)), MCOR_BUFFER(&(c)->bricks.neighbours),                             \
    MCOR_BUFFER(&(c)->topology.decisions), MCOR_BUFFER(&(c)->topology.cases),                      \
    MCOR_BUFFER(&(c)->topology.rows)

#endif
