/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_state_h
#define mcor_state_h

/* The state of a context: a struct for each phase, the call under way, and what is kept between
 * calls. */

#include "mcor_cl.h"
#include "mcor_parallel.h"
#include "mcor_parts.h"
#include "mcor_shared.h"
#include "mcor_table.h"

#define MCOR_LEVEL_LIMIT 32

/* Highest level of adaptive cubes. */
#define MCOR_TREE_LEVEL_LIMIT 24

/* [III-B] The virtual grid: world position = (origin + fixed / step) * edge, along each axis.
 * Lengths on the device are in cubes of 2^fix_bits fixed-point units. Edges are a cube long, unless
 * no cube divides all periods: `cube` is then at least the longest edge, see mcor_fit_steps. */
typedef struct mcor_lattice
{
  double cube, edge[3];
  int64_t step[3];           /* an edge in fixed-point units, at most 2^fix_bits */
  int64_t origin[3];         /* a multiple of MCOR_BLOCK_CUBES; with several levels, a multiple of
                              * the edge of a brick one level above the highest */
  int64_t first[3], last[3]; /* nodes that a particle's support may reach, counted from origin */
  int fix_bits;
  int levels; /* of cubes; 1: all have one size */
  int blocks[3];
  int period[3], period_first[3]; /* cells, 0: open; where a period begins, from origin */
  /* Where the keys of each level's blocks begin, and where all keys end. With uniform cubes, blocks
   * of higher levels are the larger cubes that mcor_make_blocks divides. */
  mcor_rung rungs[MCOR_LEVEL_LIMIT + 1];
} mcor_lattice;

/* Values that depend on whether the call is in space or in a plane. mcor_find_plane sets them. */
typedef struct mcor_space
{
  int axes;             /* 3, or 2 */
  int flat;             /* axes that cells lack; kernels take it as `plane` */
  int brick_nodes;      /* nodes of a brick; in a plane, only the lowest layer */
  int region_depth;     /* the depth that mcor_seed_regions takes */
  double ball;          /* volume of a ball of radius 1, or area of a disc */
  const char* evaluate; /* the kernel for nodes */
} mcor_space;

/* A particle of the sample, which consists of the particles whose positions have the least hashes.
 * Solids have no h and volume here; volume is 0 if volumes are computed. */
typedef struct mcor_sample
{
  uint64_t hash;
  double x[3], h, volume;
} mcor_sample;

#define MCOR_SAMPLES 256
typedef struct mcor_sample_list
{
  int count, most;              /* number of samples; its limit, at most MCOR_SAMPLES */
  mcor_sample of[MCOR_SAMPLES]; /* in the order of hashes */
} mcor_sample_list;

/* Particles on their way from the input to the search grid. */
typedef struct mcor_stage_data
{
  mcor_buffer x, y, z, inv_h, size, level; /* of each particle, in input order */
  mcor_buffer values;                      /* real: values of one component, in input order */
  mcor_buffer density;                     /* of sorted particles, while volumes are computed */
  mcor_buffer found;                       /* int: what a kernel has found in all particles */
} mcor_stage_data;

/* [III-A] The search grid. */
typedef struct mcor_grid
{
  mcor_buffer level_buffer, buckets, cell_keys, cell_begins, order;
  mcor_buffer px, py, pz, inv_h, trim_weight, fluid_weight; /* fluid_weight: only with solids */
  mcor_buffer value;
  mcor_buffer side_flags; /* uchar for each MCOR_SIDE_PARTICLES particles: on which sides of this
                           * iso value they are */
  int count;              /* particles on the device */
  int level_count, bucket_shift;
  mcor_level levels[MCOR_LEVEL_LIMIT];
  int view;         /* kernels measure in cubes of this level of adaptive cubes */
  int most_in_cell; /* most particles in a cell, at least MCOR_USUAL_IN_CELL */
  bool has_solids;
} mcor_grid;

/* The bricks that exist, and what is known of them. */
typedef struct mcor_brick_data
{
  mcor_buffer bricks;        /* int4: position in bricks */
  mcor_buffer known;         /* ulong: nodes evaluated, all or none of a brick */
  mcor_buffer value, weight; /* real [64] */
  mcor_buffer above, valid;  /* ulong: signs of nodes whose value is known or whose side is certain,
                              * see mcor_node_signs */
  int count;
} mcor_brick_data;

/* [III-B] The blocks of all levels that may have surface, and the bricks that exist in these
 * blocks. */
typedef struct mcor_bricks
{
  mcor_buffer rungs; /* mcor_rung: where each level's blocks begin, and the end */
  mcor_buffer block_keys, block_buckets;                                /* by level, z, y, x */
  mcor_buffer block_states, inactive; /* uchar; see mcor_block.cl */
  mcor_buffer states;                 /* uchar [block_count][512], see mcor_seed.cl */
  mcor_buffer bits, base;             /* [block_count][16]: bricks with slots; slots before them */
  mcor_buffer leaves, split, beside;  /* uint [block_count][16]; only with several levels, see
                                       * mcor_leaf_compare */
  mcor_buffer seed_bits, seeds;       /* seed bricks, as in `bits`; ulong, seed cells by slot */
  mcor_buffer cells;          /* ulong: cells that may be used, all or none of a brick */
  mcor_buffer plain, leaf_of; /* ulong; int, of adaptive cubes: see mcor_leaf_cells */
  mcor_buffer neighbours;     /* see mcor_brick_neighbours */
  mcor_buffer need;           /* see mcor_brick_need */
  mcor_buffer bit_counts;     /* counts for mcor_count_bits */
  mcor_buffer child_counts, child_keys, child_index; /* while cubes are divided */
  mcor_buffer regions;                               /* int: the regions to examine */
  mcor_buffer found; /* int: what a kernel found in any brick, or how many regions of each level */
  mcor_brick_data now;
  /* first_block: where each level's blocks begin; key >> block_shift: a key's bucket */
  int block_count, block_shift, first_block[MCOR_TREE_LEVEL_LIMIT + 2];
  int first_slot[MCOR_TREE_LEVEL_LIMIT + 2]; /* where each level's slots begin */
} mcor_bricks;

/* [III-D] The surface of one iso value while it is made. */
typedef struct mcor_mesh
{
  mcor_buffer used, plain_used; /* ulong: cells, see mcor_march_classify */
  mcor_buffer edges, vertex_base, triangle_base;
  mcor_buffer node, ends, offset, linear, field_value, gradient, vertex_weight, flag, evaluations;
  mcor_buffer curvature; /* real [vertex_count][2] */
  mcor_buffer means;     /* real [vertex_count][attributes.count]: means of attributes */
  mcor_buffer
    cut_edges; /* ulong: the edge that each vertex of the trim boundary is on, see mcor_trim.cl */
  mcor_buffer triangles;
  mcor_buffer scanned; /* int: numbers of vertices in the output, see mcor_is_output */
  /* march_count: the number of vertices on lattice edges, which come first. Then come vertices on
   * the trim boundary, then, from cap_first on, vertices of caps. vertex_count: all vertices.
   * Vertices on lattice edges are sorted by level, and so are vertices on the trim boundary. */
  int march_count;
  int vertex_count;
  int cap_first, cap_triangle_first; /* where vertices and triangles of caps begin */
  uint64_t* cap_keys; /* on the host: two numbers for each vertex of a cap, see mcor_cap_make.c */
  int triangle_count;
  int level_first[2][MCOR_TREE_LEVEL_LIMIT + 2]; /* first vertex of each level; first trim vertex of
                                                  * each level */
} mcor_mesh;

/* A set of bricks of one level of adaptive cubes. Bricks are in clusters of 4^3, which begin at
 * multiples of 4. clusters: for the key of a cluster's first brick, a mask of the cluster's bricks
 * in the set; brick (x, y, z) of the cluster has bit x + 4 y + 16 z. */
typedef struct mcor_brick_set
{
  mcor_table clusters;
  size_t count; /* number of bricks */
} mcor_brick_set;

/* The leaves (undivided bricks) of adaptive cubes, in blocks; see mcor_tree.h. */
typedef struct mcor_tree
{
  const mcor_lattice* lattice;
  int top;       /* highest level of leaves; bricks go one level higher */
  bool is_plane; /* all bricks are in the lowest layer */
  /* The length of the period and the coordinate where the first period begins, in bricks of each
   * level; length 0: no period along this axis. */
  int period[MCOR_TREE_LEVEL_LIMIT + 2][3], period_first[MCOR_TREE_LEVEL_LIMIT + 2][3];
  mcor_brick_set split[MCOR_TREE_LEVEL_LIMIT + 2];
  int leaf_count;
  int block_count, first_block[MCOR_TREE_LEVEL_LIMIT + 2]; /* where each level's blocks begin */
  uint64_t* block_keys;                                    /* [block_count], ascending */
  cl_uint *leaves, *is_split;                              /* bits [block_count][16] */
} mcor_tree;

/* The leaves that are marched, and the slots of their nodes; see mcor_leaf.c. */
typedef struct mcor_adaptive
{
  mcor_buffer chosen, scanned; /* bits of the listed leaves, by block; int: how many listed leaves
                                * come before */
  mcor_buffer cells, finer; /* int4, uint: the listed leaves, in order; which bricks around each are
                             * finer */
  mcor_buffer tables;       /* int [MCOR_LEAF_SLOTS]: slots of each leaf's nodes */
  mcor_buffer mixed;        /* uchar: whether each leaf has nodes on both sides of the iso value */
  mcor_buffer proofs;       /* uchar: state of each slot */
  mcor_buffer quadrants;    /* uint [MCOR_QUADRANT_WORDS], of a slot's edges */
  mcor_buffer flat;         /* int: loops that lie in one face between leaves */
  int count;                /* number of leaves that may have surface */
} mcor_adaptive;

/* The cells that pairs of particles mark, and the cells reached from them; see mcor_pair.c. */
typedef struct mcor_pairs
{
  /* Masks of cells: a ulong for each brick of all blocks, by the brick's number. marked: cells
   * between the particles of pairs. reached: the marked cells, and all cells that growth through
   * crossed faces has reached from them. grown: the reached cells from which growth has gone on
   * already. */
  mcor_buffer marked, reached, grown;
  mcor_buffer domain; /* ulong, by slot: cells where growth may go */
  mcor_buffer found;  /* int: what a kernel found in any brick */
} mcor_pairs;

/* Points, as nodes and offsets, and the field at them. */
typedef struct mcor_field_points
{
  mcor_buffer node, offset, value, gradient, weight;
} mcor_field_points;

/* MCOR_TOPOLOGY_FIELD: samples of the field decide how ambiguous faces and cells are
 * triangulated. */
typedef struct mcor_topology_data
{
  mcor_buffer decisions; /* see MCOR_DECISION_MASKS */
  mcor_buffer counts, sample_base;
  mcor_field_points samples;
} mcor_topology_data;

/* Groups of points at which the field is evaluated, see mcor_make_groups. */
typedef struct mcor_points
{
  mcor_buffer flags, groups;
} mcor_points;

/* Points, as nodes and offsets, at which the field is evaluated in sorted order. in_node and
 * in_offset are in the order of the input. */
typedef struct mcor_point_batch
{
  mcor_buffer keys, order, in_node, in_offset, node, offset;
  cl_int first[3], bricks[3]; /* the bricks that hold the points: the fewer, the shorter the keys */
} mcor_point_batch;

/* [III-D.3] Trimming. */
typedef struct mcor_trim_data
{
  mcor_buffer eigenvalue;       /* real, at vertices; the vertex threshold may apply to it */
  mcor_buffer margin;           /* real, at vertices; see mcor_trim_margin */
  mcor_buffer remaining, cuts;  /* counts for each batch of triangles */
  mcor_buffer keys, index;      /* keys of cut edges */
  mcor_buffer triangles, cells; /* triangles that trimming leaves, until the mesh and the box take
                                 * them */
} mcor_trim_data;

/* Buffers for sorting. mcor_unique and mcor_list_runs also use `flags`; mcor_unique also uses
 * `order`. */
typedef struct mcor_sort_data
{
  mcor_buffer keys, values, histogram, order, flags;
} mcor_sort_data;

typedef struct mcor_component
{
  int attribute, component;
  double shift, scale; /* on the device: (value - shift) * scale */
  double low, high;    /* range over fluid particles; a probe's means lie within it */
} mcor_component;

/* The attribute components to evaluate: for a surface, the ones that vary; for samples, all. The
 * device holds `count` of them, from component `first` on. */
typedef struct mcor_attributes
{
  mcor_component* varying; /* [varying_count] */
  int varying_count;
  int first, count;
  mcor_buffer sorted;  /* real [count][grid.count] */
  uint64_t kept;       /* the attributes_version of a probe for which everything here holds, or 0 */
  mcor_buffer nearest; /* int: the particle nearest to each vertex */
} mcor_attributes;

/* Which rank counts a vertex; 0: none. */
enum
{
  MCOR_OWN = 1,     /* this rank */
  MCOR_ANOTHERS = 2 /* another rank */
};

/* The cells that a call owns, see mcor_box.c. */
typedef struct mcor_box
{
  /* is_part: there is a period, or this call does not own all cells; is_empty: this call owns no
   * cell */
  bool is_part, is_empty;
  int ring;               /* width of the ring of cells that are examined around the owned ones */
  int first[3], last[3];  /* owned cells, [first, last), from the lattice's origin */
  int
    halves[6]; /* the box of the owned cells, x0, y0, z0, x1, y1, z1, in halves of the smallest
                * cubes */
  bool of_points;  /* whether this is the box of a probe's points, `points`: x0, x1, y0, ... */
  bool has_points; /* whether `points` is known */
  double points[6];
  int whole_first[3], whole_last[3], whole_halves[6]; /* the cells that any rank owns */
  mcor_buffer cells;   /* ulong per triangle of the mesh, see mcor_triangle_cell.c */
  mcor_buffer clipped; /* ulong per brick, of mcor_count_cells */
  uint8_t* kept;       /* per triangle of the surface: 1: its cell is owned; NULL: all are */
} mcor_box;

/* The iso value whose surface is made. It is 0 while filling evaluates the points that it adds. */
typedef struct mcor_iso
{
  int number; /* index in options.iso_values; iso_count while filling adds points */
  double value, relative; /* the iso value; the iso value minus value_shift, for the device */
} mcor_iso;

/* The call under way; options are NULL between calls. */
typedef struct mcor_run
{
  const mcor_options* options;
  bool uses_solids; /* whether solid particles must be on the device */
  double widest; /* greatest factor of lengths in sums at particles, see mcor_widen.c; 0: no sums */
  bool is_too_long;     /* the lattice around all particles would be too long, see mcor_far.c */
  struct mcor_far* far; /* particles that are left out so that the lattice fits; NULL: none */
  struct mcor_filling* fill; /* lines of the iso values that are done, see mcor_fill.c; or NULL */
  mcor_statistics* statistics;
  mcor_iso iso;
  mcor_phase phase;
  double phase_begin, phase_built; /* phase_built: cl.build_seconds when the phase began */
  const char* doing;               /* what runs, as reported last */
  double fraction,
    fraction_end;     /* fraction reported last, even by a failed attempt; fraction at the end of
                       * the present work */
  double report_time; /* time of the last report */
  bool building_told; /* whether the last report was about building */
  double correction_count, correction_sum, correction_squares;
  int64_t evaluations_counted; /* sum of the evaluations of vertices_corrected */
  int64_t normals_lacking;     /* number of points without a normal so far */
} mcor_run;

/* What the last call was given, and which of its results are still valid; see mcor_reuse.c. */
typedef struct mcor_kept
{
  mcor_input input;
  mcor_options options;
  mcor_globals globals; /* the last call's globals, whose arrays must not be read; 0: none were
                         * given */
  uint64_t splits;      /* hash of the globals' split bricks */
  bool uses_solids;     /* whether solid particles are on the device */
  bool grid, value;
  bool nodes; /* whether bricks hold node values of the current scalar */
} mcor_kept;

struct mcor_context
{
  bool created; /* false: mcor_create_context failed */
  mcor_says code;
  char error[4096], told[4096]; /* the last failure: with slots, and with filled slots */
  mcor_run run;
  mcor_pool pool; /* threads of the host during a call, unless the device is the built-in one */

  /* The device, and data that do not depend on the particles. */
  mcor_cl cl;
  mcor_buffer cases, case_rows; /* mcor_case_table */
  mcor_buffer scan_sums;
  mcor_sort_data sort;
  double report_interval; /* seconds between progress reports, at least */

  /* The particles. */
  mcor_kept kept;
  mcor_sample_list samples[2]; /* of fluid particles, of solids */
  mcor_measure measure;
  mcor_lattice lattice;
  mcor_plane plane; /* the plane and the space of the present call */
  mcor_space space;
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
  mcor_pairs pairs;
  mcor_topology_data topology;
  mcor_mesh mesh;
  mcor_points points;
  mcor_trim_data trim;
};

#endif
