/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_h
#define mcor_h

/* Marching Correctors: isosurfaces of SPH data, exact with respect to the SPH representation.
 *
 *   B. Schindler, R. Fuchs, J. Waser, R. Peikert: Marching Correctors - Fast and Precise Polygonal
 *   Isosurfaces of SPH Data. 6th International SPHERIC Workshop, Hamburg, 2011.
 *
 * A C11 library on OpenCL 1.2; it needs no VTK. One call does the whole job:
 *
 *   mcor_context *context;
 *   mcor_create_context(NULL, &context);
 *   mcor_set_default_options(&options);   (then options.iso_values, options.iso_count)
 *   mcor_extract(context, &input, &options, &surface);   (errors: mcor_last_error(context))
 *   ... use surface ...
 *   mcor_free_surface(&surface);
 *   mcor_free_context(context);
 *
 * Every function that can fail returns a mcor_status, MCOR_OK being 0; outputs are then empty and
 * safe to free. The library never prints, never exits and keeps no global state. A context may be
 * used by one thread at a time; different contexts by different threads. mcor_extract has up to 15
 * threads help it, on the processors that its caller's thread may use; they end before it returns.
 *
 * Lengths are in the unit of the particle positions ("length unit L").
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

#define MCOR_VERSION "0.1.0"

  typedef enum mcor_status
  {
    MCOR_OK = 0,
    MCOR_INVALID_ARGUMENT, /* a parameter outside its legal range, or a needed array missing */
    MCOR_INVALID_DATA,     /* an array holds NaN, an infinite value, or an illegal value */
    MCOR_OUT_OF_CAPACITY,  /* lattice, device memory or host memory would not suffice */
    MCOR_DEVICE_ERROR,     /* no OpenCL platform or device, build failure, a device that vanished */
    MCOR_CANCELLED         /* the progress callback asked to stop */
  } mcor_status;

  /* Element type of an array. */
  typedef enum mcor_type
  {
    MCOR_FLOAT32 = 0,
    MCOR_FLOAT64 = 1
  } mcor_type;

  /* SPH smoothing kernels W; q = r / smoothing length. Formulas: mcor_sph_kernel.h. */
  typedef enum mcor_sph_kernel
  {
    MCOR_CUBIC_SPLINE = 0,   /* M4, support radius 2; the default */
    MCOR_QUADRATIC = 1,      /* support radius 2 */
    MCOR_M_PRIME_4 = 2,      /* tensor product of 1-D M'4, support 2 along each axis (a cube) */
    MCOR_QUINTIC_SPLINE = 3, /* M6, support radius 3 */
    MCOR_WENDLAND_C2 = 4,    /* support radius 2 */
    MCOR_SPH_KERNEL_COUNT
  } mcor_sph_kernel;

  /* What is contoured. V: particle volume, A: scalar, W: kernel. */
  typedef enum mcor_field
  {
    MCOR_SHEPARD = 0,   /* sum V A W / sum V W; the default */
    MCOR_SUM = 1,       /* sum V A W, the paper's field; 0 in all empty space, so iso value 0 with
                         * node threshold 0 gives no sensible surface */
    MCOR_WEIGHT_SUM = 2 /* sum V W: the free surface; needs no scalar, applies no threshold */
  } mcor_field;

  typedef enum mcor_seed_mode
  {
    MCOR_COMPLETE = 0, /* every cell that a bound cannot exclude is examined; nothing is missed */
    MCOR_PAIRS = 1     /* the paper's: cells between pairs of particles no farther apart than the
                        * smoothing length (not scaled) that straddle the iso value; the same as
                        * complete for MCOR_WEIGHT_SUM, which has no values at particles */
  } mcor_seed_mode;

  /* How the nodes of an ambiguous face (two above the iso value and two below, diagonally) and the
   * interior of a cell are connected. Vertices are the same; the surface is a manifold with
   * both. */
  typedef enum mcor_topology
  {
    MCOR_TOPOLOGY_TABLE = 0, /* nodes above are kept apart on such faces, no cell has a tunnel */
    MCOR_TOPOLOGY_FIELD = 1 /* as the field is at the saddle of the face's bilinear interpolant, and
                              * at those of the cell's trilinear one: bridges and tunnels as wide as
                              * a cube are those of the field */
  } mcor_topology;

/* Levels of cubes, 0 to 24. The cubes of the virtual grid are as fine as the particles are: their edge
 * is 2^L times the cube size where all particles that reach a brick of 4^3 such cubes have 2^L times
 * the smallest smoothing length or more; bricks that touch differ by one level at most. The surface is
 * closed across levels. With one smoothing length for all particles, all cubes are of level 0. With
 * MCOR_TOPOLOGY_FIELD the field decides on faces between two cubes that no finer cube touches, and in
 * such cubes; other ambiguous faces are as with MCOR_TOPOLOGY_TABLE. With a period, which is a whole
 * number of the largest bricks, there may be fewer levels: see mcor_statistics.highest_level. */
#define MCOR_CUBE_LEVELS 25

  /* How trimming tells where the fluid ends. Both are about 1 inside and have no unit. */
  typedef enum mcor_boundary_detection
  {
    MCOR_BOUNDARY_WEIGHT_SUM = 0, /* the trimming weight sum V W; the default */
    MCOR_BOUNDARY_EIGENVALUE = 1  /* the smallest eigenvalue of the symmetric part of
                                   * sum V (x_j - x) (outer product) grad W(x - x_j), the inverse of
                                   * the renormalisation matrix (Marrone et al. 2010), over the same
                                   * particles. Set vertex_threshold too: 0.3 trims about where a
                                   * weight of 0.5 does; 0.75 within the fluid, 0.9 smoothing lengths
                                   * from a flat surface. Not 0.5, which it has there over a depth of
                                   * half a smoothing length. */
  } mcor_boundary_detection;

  /* A per-particle quantity, or one constant for all particles. */
  typedef struct mcor_array
  {
    const void* data; /* [count][components], finite (but attributes); borrowed until return;
                       * NULL: constant */
    mcor_type type;
    int components;   /* 1 unless said otherwise; 0 is read as 1 */
    double constant;  /* the value of all particles where data is NULL */
    const char* name; /* for messages; may be NULL */
  } mcor_array;

  /* Whether there is one: data, or a constant other than 0. */
  int mcor_is_given(const mcor_array* array);

#define MCOR_MAGNITUDE (-1)

  typedef struct mcor_input
  {
    int64_t count;        /* number of particles; 0 gives an empty surface */
    mcor_array positions; /* [count][3], length unit L, data must not be NULL */

    /* Smoothing length, unit L, > 0. It is the kernel's support radius instead where
     * smoothing_length_is_support_radius is set. With estimate_smoothing_length, the array is not
     * read: the value is 1.3 times the median particle spacing, one constant. */
    mcor_array smoothing_length;
    int smoothing_length_is_support_radius;
    int estimate_smoothing_length;

    /* Particle volume, unit L^3, > 0: `volume` if given (data, or a constant other than 0); else
     * mass / density if both are given; else with mass alone m_j / sum_k m_k W(x_j - x_k, h_j); else
     * 1 / sum_k W(x_j - x_k, h_j). These sums leave out solids that are ignored, and all solids for
     * MCOR_WEIGHT_SUM (unless that ends at them), so that such volumes next to walls differ between
     * the fields. */
    mcor_array volume, mass, density;

    /* The scalar A to contour; not read for MCOR_WEIGHT_SUM. With 2 or more components,
     * scalar_component selects one, or MCOR_MAGNITUDE the Euclidean norm. If scalar_dot.data is not
     * NULL, A is the dot product of the two vectors. Values of more than about 1e30 need double
     * precision, of more than 1e290 another unit. */
    mcor_array scalar;
    int scalar_component;
    mcor_array scalar_dot;

    /* [count], borrowed; nonzero: a solid (wall) particle. NULL: all particles are fluid. Solid
     * particles never take part in the field. They count in the weight used for trimming unless
     * ignore_solids is set; the surface may end at them, see mcor_options.wall_share. */
    const uint8_t* solid;
    int ignore_solids;

    /* Other per-particle arrays to interpolate to the surface (Shepard mean of fluid particles). One
     * that is not finite for a fluid particle is left out, see attribute_not_finite. */
    const mcor_array* attributes; /* [attribute_count] */
    int attribute_count;

    /* Reuse: equal nonzero numbers in two successive calls promise that positions, smoothing
     * lengths, volumes and solids (particles_version), the scalar (scalar_version), or all attributes
     * (attributes_version: mcor_probe then keeps them on the device) are the same. Reuse saves time and
     * never changes the result. 0: never reuse. */
    uint64_t particles_version;
    uint64_t scalar_version;
    uint64_t attributes_version;
  } mcor_input;

/* The default wall share: of a scalar's surface the one that is measured, of the free surface none. */
#define MCOR_WALL_SHARE_AUTO (-2)

/* A wall share that is measured: the solids' share of the weight at some solids themselves, the median,
 * each one counting as much as the fluid weighs there. A surface of the scalar then ends, in the median, on
 * the solids that face the fluid, whether they are one layer or more, and how far away the fluid keeps.
 * The free surface keeps in front of that layer: there it is 0.5. */
#define MCOR_WALL_SHARE_MEASURED (-1)

  /* A surface in parts, made by several processes or from some of the particles: see mcor_parts.h. */
  typedef struct mcor_globals mcor_globals;
  typedef struct mcor_ranks mcor_ranks;

  typedef struct mcor_options
  {
    mcor_sph_kernel sph_kernel;
    mcor_field field;
    mcor_seed_mode seeds;
    mcor_topology topology;
    double h_scale;          /* the kernel uses h_scale * smoothing length; volumes do not change */
    double cube_size_factor; /* cube size = factor * smallest smoothing length; default 0.5 */
    double cube_size;        /* unit L; > 0 overrides the factor */
    int level_limit; /* highest level of cubes, see MCOR_CUBE_LEVELS; 0: uniform cubes; default 24;
                              * mcor_probe and mcor_derive do not read it */
    const double* iso_values; /* [iso_count], finite; none give an empty surface */
    int iso_count;
    double node_threshold; /* cells with a node of lower weight are discarded; default 0.1. So
                            * are Shepard cells with a node of a fluid weight below 0.001. */
    mcor_boundary_detection boundary_detection;
    double vertex_threshold; /* triangles are trimmed where the weight (or the boundary eigenvalue)
                              * is lower; default 0.5. A Shepard mean's are, at any rate, where the
                              * fluid's own weight is below 0.001, with M'4, whose lobes let it pass 0,
                              * below 0.05: no mean is there, but a pole. */
    double wall_share;    /* above 0: the surface, the free surface too, also ends where the solids'
                        * share of the weight, unless they are ignored, becomes greater than this;
                        * 0.5: where they weigh more than the fluid. 0: nowhere. MCOR_WALL_SHARE_AUTO (the
                        * default), MCOR_WALL_SHARE_MEASURED: see there */
    int preview;          /* nonzero: vertices by linear interpolation, no correction */
    double tolerance;     /* |f - iso| reached by the correction / range of A; default 1e-6 */
    int iteration_limit;  /* of the correction, per vertex; 1 to 255, default 30 */
    mcor_type precision;  /* of the field evaluation on the device; MCOR_FLOAT32 by default */
    int64_t memory_limit; /* bytes of device memory in use and kept, >= 0; 0: all there is. What
                              * is kept for reuse is given back before a run fails for want of it. */

    /* Not all 0: the surface is that of the cells whose centres are in the box, box[2 a] <= x <
     * box[2 a + 1] along axis a, to the last bit: boxes side by side make the whole surface. Sides
     * may be infinite. What is global (lattice, ranges, smallest h) is measured over all particles;
     * only those that reach the box are evaluated. Not with MCOR_PAIRS, unless there are ranks: pair
     * cells grow from cell to cell, wherever they begin, so that without ranks the whole surface is
     * evaluated up to the correction. mcor_probe and mcor_derive read the box only with globals. */
    double box[6]; /* x0, x1, y0, y1, z0, z1; unit L */

    /* x0, x1, y0, y1, z0, z1; unit L. Where x0 < x1, particles and all they carry repeat along x
     * with that period: each is taken to where it is between x0 and x1, and its images count. The
     * surface is that of one period, open at its sides, where it meets itself: points a period apart
     * agree in all bits, but for the coordinate along it, which is rounded. All periods are whole numbers
     * of cubes: the cube size is made to fit, smaller by less than a half. x0 = x1, the default 0: open.
     * For mcor_probe and mcor_derive, too: points may be anywhere. */
    double periodic[6];
    /* Nonzero: the surface is closed at periodic sides by flat triangles there, around the particles'
     * side of it: where values are above the iso value. Its border's points are shared; the others
     * are nodes of the virtual grid, with normals out of the period, boundary flag 8, and a residual
     * that means nothing. Trimming cuts caps, too, and leaves its border open. All cubes are then of the
     * smallest size. Of a box the sides of its cells are closed that are sides of the period, but not
     * of one that no particle reaches, where a sum's iso value of 0 has empty space above it. Not with
     * MCOR_PAIRS; of no effect without a period. */
    int capping;

    /* NULL: measured over the input. Else of all particles, of which the input holds some: at least
     * those whose supports miss the box by no more than mcor_reach_margin, with computed volumes also all within the
     * (unscaled) support of these, with MCOR_PAIRS also all within the (unscaled) smoothing length of
     * the box, and of these. The surface is, to the last bit, that from all of them. Borrowed
     * until return. See mcor_measure_globals. For mcor_probe and mcor_derive these are of
     * mcor_measure_probe_globals, and the box tells where results are wanted: at points in it, its
     * sides too; others' mean nothing, those of particles two cubes away from it and more are 0. */
    const mcor_globals* globals;

    /* NULL: alone. mcor_measure_globals measures over all ranks' inputs, each particle being in one of
     * them (a rank without any has count 0, and data that are not NULL where others have data): what it
     * returns are, to the last bit, the globals of all particles in one input, but for not_finite, a
     * number on the rank that has the least. So does mcor_measure_probe_globals. mcor_extract with these globals, and MCOR_PAIRS, lets cells
     * grow from box to box; each cell is to be in the box of one rank. Borrowed until return; others do
     * not read it. */
    const mcor_ranks* ranks;

    /* What the surface carries besides points and triangles. */
    int normals; /* default on */
    int gradients, weight_sum, boundary_eigenvalue, correction_length, residual, boundary_flag;
    int iso_value, nearest_particle;
    int point_keys;       /* see MCOR_POINT_KEY */
    int triangle_keys;    /* see MCOR_TRIANGLE_KEY */
    int triangle_normals; /* normals by area-weighted triangle normals instead of the gradient */

    /* Called between device launches with 0 <= fraction <= 1; nonzero return: stop. May be NULL. */
    int (*progress)(void* user, double fraction, const char* phase);
    void* progress_user;
  } mcor_options;

  /* Phases, in the order in which they run. */
  typedef enum mcor_phase
  {
    MCOR_PHASE_INPUT = 0,   /* checks, unit conversion, transfer to the device */
    MCOR_PHASE_SEARCH_GRID, /* search grid and volumes */
    MCOR_PHASE_SEEDS,       /* seed selection; complete seeds: node evaluation */
    MCOR_PHASE_EXTRACTION,  /* the rest of the nodes, marching cubes */
    MCOR_PHASE_CORRECTION,  /* Newton iteration, normals, attributes */
    MCOR_PHASE_TRIMMING,
    MCOR_PHASE_OUTPUT, /* compaction and transfer to the host */
    MCOR_PHASE_COUNT
  } mcor_phase;

  typedef struct mcor_statistics
  {
    double seconds[MCOR_PHASE_COUNT];
    double build_seconds; /* compiling or loading kernels, in whichever phase; in none of seconds */
    int64_t fluid_particles, solid_particles;
    int64_t particles_in_reach; /* on the device: with a box those that are needed there */
    double smoothing_length_min, smoothing_length_max; /* of fluid particles, unit L, unscaled */
    /* Medians over some fluid particles: smoothing length; particles, itself and solids too, within
     * its unscaled support radius; distance to the nearest other one of these, 0: there is none;
     * share of the support that their volumes fill, as far as they are as large as the particle's,
     * 0 where volumes are computed. */
    double smoothing_length_median, neighbours_median, spacing_median, filled_median;
    double wall_share;             /* in use; 0: the surface does not end at solids */
    double fluid_extent[3];        /* of the positions of fluid particles, along x, y, z */
    double cube_size;              /* unit L */
    double scalar_min, scalar_max; /* over fluid particles */
    /* Of the part of the virtual grid in the box, where there is one; so are all counts of cells and
     * triangles, and those of vertices; a vertex that several ranks have is counted by one of them.
     * Those of bricks, nodes, faces and evaluations are of what was done, around the box, too. */
    int64_t lattice_origin[3]; /* lowest node of the virtual grid: world position / cube size */
    int64_t lattice_cells[3];
    int64_t virtual_cells; /* product of lattice_cells, below 2^63 */
    /* Complete seeds: of uniform cubes, the cells that bounds over 8 x 8 x 8 nodes do not exclude; of
     * adaptive ones, those in leaves that the surface passes through. Pairs: the cells between them, of
     * adaptive cubes in such leaves alone. And those that the surface does not use. Summed over iso
     * values, as are the next. */
    int64_t seed_cells, seed_cells_not_intersected;
    int64_t bricks, nodes_evaluated;
    int64_t cells_used; /* intersected cells of the surface, before trimming */
    int64_t triangles_before_trimming;
    int64_t cap_triangles; /* of caps; not among the ones before */
    int64_t march_rounds;
    /* Adaptive cubes: used cells and triangles, before trimming, by the level of their cell. Loops
     * of a cell's triangles that lie in one side of it, next to finer cells, whose part of the surface
     * they cut off. */
    int64_t cells_of_level[MCOR_CUBE_LEVELS], triangles_of_level[MCOR_CUBE_LEVELS];
    int64_t flat_loops;
    int highest_level; /* that cubes may have, by smoothing lengths, level_limit and periods */
    /* MCOR_TOPOLOGY_FIELD: ambiguous faces, and those where nodes above are joined, unlike by the
     * table; cells with two loops that might be a tunnel, and those where they are. */
    int64_t ambiguous_faces, joined_faces, ambiguous_cells, tunnels;
    /* Correction, Table V: distance between linear and corrected vertex, unit L. */
    double correction_mean, correction_max, correction_deviation;
    int64_t correction_count; /* vertices that the mean is of: the surface's but for cuts */
    int64_t vertices_corrected, newton_evaluations, vertices_above_tolerance;
    double iterations_mean;
    int iterations_max;
    double residual_max; /* max |f - iso| as evaluated on the device, in the scalar's unit */
    /* Rounding of positions on the device, unit L, at most: residuals are of positions so rounded. */
    double position_error;
    int64_t trim_vertices, trim_vertices_linear; /* linear: kept at the linear cut */
    int64_t device_bytes_peak;
    char device[128], platform[128];
  } mcor_statistics;

  /* A point's key: number of the iso value and whether it is a cut or of a cap, then its lattice edge, the two
   * between whose points it was cut, or the cap's square. Points of a surface have different keys, ascending one number
   * after the other; those of a box's surface have the keys that they have in the whole surface. */
#define MCOR_POINT_KEY 3

  /* A triangle's key: number of the iso value, then its cell, or its square of a cap. Keys ascend from triangle to triangle; those of
   * one cell have the same. A box's triangles have the keys that they have in the whole surface, each
   * cell being in one box, so that the whole surface's triangles are those of boxes, sorted by key and
   * otherwise left in order. */
#define MCOR_TRIANGLE_KEY 2

  /* A triangle mesh. Vertices are shared; a triangle's normal (right-hand rule) points to lower
   * values of the field, as vtkContourFilter orients it. Owned; free with mcor_free_surface. */
  typedef struct mcor_surface
  {
    int64_t point_count, triangle_count;
    double* points;          /* [point_count][3], unit L */
    int32_t* triangles;      /* [triangle_count][3], point indices */
    uint64_t* triangle_keys; /* [triangle_count][MCOR_TRIANGLE_KEY]; NULL where not asked for */
    /* Optional arrays, NULL where not asked for. */
    float* normals;             /* [point_count][3], unit length, towards lower values */
    double* gradients;          /* [point_count][3], gradient of the field, scalar unit / L */
    float* weight_sum;          /* [point_count], the trimming weight */
    float* boundary_eigenvalue; /* [point_count], see MCOR_BOUNDARY_EIGENVALUE */
    float* correction_length;   /* [point_count], unit L */
    float* residual;            /* [point_count], f - iso, scalar unit */
    uint8_t* boundary_flag;     /* [point_count], 0 inside; 1 on the trim boundary, weight (or
                             * eigenvalue) = vertex threshold or solids' share = wall share; 2 same, but left at the linear cut;
                             * 4 on a lattice edge next to a cell that the node threshold
                             * discarded; 8 of a cap alone, see capping */
    double* iso_value;          /* [point_count] */
    int64_t* nearest_particle;  /* [point_count], index of the nearest fluid particle */
    uint64_t* point_keys;       /* [point_count][MCOR_POINT_KEY] */
    double** attributes;        /* [attribute_count] -> [point_count][components] */
    int64_t*
      attribute_not_finite; /* [attribute_count], -1; or, of an attribute that holds NaN or an
                             * infinite value, the first fluid particle that has it: this attribute
                             * was left out, its entry in `attributes` is NULL */
    int attribute_count;
    mcor_statistics statistics;
  } mcor_surface;

  typedef struct mcor_context mcor_context;

  /* Device: NULL or "" the default (PoCL's, else the first one), a number as listed by
   * mcor_list_devices, or part of a device's or platform's name. On failure *context still holds a
   * context whose mcor_last_error says why (NULL only if host memory ran out). */
  mcor_status mcor_create_context(const char* device, mcor_context** context);
  void mcor_free_context(mcor_context* context);

  /* One line per device, "number: device (platform)\n"; *text is to be freed with free(). An empty
   * text means that there is no OpenCL device. */
  mcor_status mcor_list_devices(char** text);

  /* The sentence that belongs to the last failure of this context, "" if there was none. Valid
   * until the next call on the context. */
  const char* mcor_last_error(const mcor_context* context);
  const char* mcor_status_name(mcor_status status);
  const char* mcor_phase_name(mcor_phase phase); /* "search grid", "seeds", ... */

  /* Kernel by its command-line name ("cubic", "quadratic", "mprime4", "quintic", "wendland") and
   * back; -1 or NULL where there is none. */
  int mcor_find_sph_kernel(const char* name);
  const char* mcor_sph_kernel_name(mcor_sph_kernel kernel);
  double mcor_support_factor(mcor_sph_kernel kernel); /* support radius / smoothing length */

  /* What a particle array may hold, by its name. */
  typedef enum mcor_quantity
  {
    MCOR_SMOOTHING_LENGTH = 0,
    MCOR_VOLUME,
    MCOR_MASS,
    MCOR_DENSITY,
    MCOR_VELOCITY,
    MCOR_PARTICLE_ID,   /* a whole number of its own, the same at all times */
    MCOR_PARTICLE_TYPE, /* what tells fluid from solids */
    MCOR_QUANTITY_COUNT
  } mcor_quantity;

  /* 0 for the name that is most usual for the quantity, more for less usual ones, -1 for others.
   * Case, blanks, "_" and "-" do not matter. */
  int mcor_name_priority(mcor_quantity quantity, const char* name);

  /* Whether an array of this name, whose values are whole and range from low to high over all particles,
   * says clearly which of them are fluid: *fluid becomes the value that these have. So do 0 and 1 alone,
   * and the codes of DualSPHysics. */
  int mcor_find_fluid_value(const char* name, double low, double high, double* fluid);

  /* How fit an array of this name is to be looked at where nobody has chosen one; the least is best:
   * velocities, other vectors, scalars, what describes particles, the rest. -1: not fit, as it does
   * not vary (`varies`: whether any component has two values), or numbers particles or their types. */
  int mcor_view_priority(const char* name, int components, int is_real, int varies);

  /* The solver whose output has arrays of these names, each on a line: "DualSPHysics", "PySPH",
   * "SWIFT", "GADGET", "SPH-EXA", "Phantom"; "" for others. */
  const char* mcor_find_layout(const char* names);

  /* A numeric array of a particle file's field data, in tuples of any size. */
  typedef struct mcor_field_data
  {
    const char* name;     /* may be NULL */
    const double* values; /* [count]; borrowed until return */
    int64_t count;
  } mcor_field_data;

  /* The period that field data tell of: an array PeriodicBounds, BoxSize (GADGET, SWIFT), or box where
   * boundaryType says that it repeats (SPH-EXA). Spelt as for mcor_name_priority. Returns how many numbers
   * `period` has: 6 bounds, as mcor_options.periodic; 3 lengths, for mcor_place_period; 0: no array
   * tells of a period. which: the number of the array; may be NULL. */
  int mcor_find_period(const mcor_field_data* arrays, int count, double period[6], int* which);

  /* Bounds of a period of which only the lengths are known: along each axis from 0 on or around 0, if
   * the particles, of this extent (x0, x1, ...), lie in them, else from the first particle on. */
  void mcor_place_period(const double lengths[3], const double extent[6], double bounds[6]);

  /* Whether mcor_find_period looks at arrays of this name. */
  int mcor_tells_of_period(const char* name);

  /* Whether the options have a box. */
  int mcor_has_box(const mcor_options* options);

  /* Sets every option to its default; iso_values stays empty. */
  void mcor_set_default_options(mcor_options* options);

  /* Extracts the surface. *surface is overwritten: initialise it with {0} or free it before. */
  mcor_status mcor_extract(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_surface* surface);
  void mcor_free_surface(mcor_surface* surface);

  /* Least and greatest value of the scalar at fluid particles, where it is finite, and an iso value for
   * those who have named none: one of the values, the median; where all are positive and range over
   * three decades (without the 2 % lowest and highest), the middle of the range in logarithms. Of the input
   * the scalar and solids alone are read; of all ranks, unless that is NULL. Returns 0, and changes
   * nothing, where there is no such particle, or a rank has given up. */
  int mcor_find_iso_value(
    const mcor_input* input, const mcor_ranks* ranks, double range[2], double* iso_value);

  /* What may be wrong with the input of an extraction that succeeded. */
  typedef enum mcor_warning
  {
    MCOR_WARN_NEIGHBOURS = 0, /* far too few or too many, see neighbours_median */
    MCOR_WARN_PLANE,          /* the particles lie in a plane, as in a 2-D simulation */
    MCOR_WARN_ISO_VALUE,      /* outside of the field's range */
    MCOR_WARN_TRIMMED,        /* a threshold leaves nothing of the surface */
    MCOR_WARN_PRECISION,      /* positions are rounded too much, see position_error */
    MCOR_WARN_TOLERANCE, /* some vertices are off the iso value, see vertices_above_tolerance */
    MCOR_WARNING_COUNT
  } mcor_warning;

  /* A sentence with figures for one of these, to be freed with free(); NULL where nothing is wrong,
   * or memory ran out. Takes what mcor_extract was given and made. */
  char* mcor_describe_warning(mcor_warning warning, const mcor_input* input,
    const mcor_options* options, const mcor_surface* surface);

  /* A sentence, to be freed with free(), about an array of particle types (MCOR_PARTICLE_TYPE) where
   * all particles count as fluid: it has counts[i] times values[i]. NULL where such an array tells
   * nothing, as it has one value, or more than MCOR_PARTICLE_TYPES; or memory ran out. */
  char* mcor_describe_unused_type(
    const char* name, const double* values, const int64_t* counts, int count);
#define MCOR_PARTICLE_TYPES 8
/* The array that says, of blocks that are one set, which particles are of blocks whose names tell of walls. */
#define MCOR_WALL_BLOCK "WallBlock"

  /* The field at points of the caller's choice. Owned; free with mcor_free_samples. */
  typedef struct mcor_samples
  {
    int64_t count;           /* of points */
    double* weight_sum;      /* [count], of fluid particles */
    double* weight_gradient; /* [count][3], unit 1 / L; NULL unless options.gradients */
    uint8_t* valid; /* [count], 1 where the weight sum is not below options.node_threshold */
    /* Of each attribute of the input the field at the points, the Shepard mean or the sum as
     * options.field says (MCOR_WEIGHT_SUM: the mean), and its gradient. 0 where not valid. */
    double** values;               /* [attribute_count] -> [count][components] */
    double** gradients;            /* [attribute_count] -> [count][components][3], per L; NULL
                                    * unless options.gradients */
    int64_t* attribute_not_finite; /* [attribute_count], as in mcor_surface */
    int attribute_count;
    mcor_statistics statistics;
  } mcor_samples;

  /* Evaluates the field at points: [count][3], unit L; a point that is not finite is not valid. The
   * input's scalar is not read. Of the options sph_kernel, field, h_scale, gradients, node_threshold,
   * precision, memory_limit, periodic and progress count; cube_size and cube_size_factor are the unit of
   * length on the device, made to fit periods, and do not matter otherwise. A point's bits do not depend on
   * the other points. *samples is overwritten. */
  mcor_status mcor_probe(mcor_context* context, const mcor_input* input,
    const mcor_options* options, const mcor_array* points, int64_t count, mcor_samples* samples);
  void mcor_free_samples(mcor_samples* samples);

  /* A straight line along which the free surface is measured. */
  typedef struct mcor_gauge_line
  {
    double from[3], to[3]; /* unit L, finite, not at one place */
    const char* name;      /* for messages; may be NULL */
  } mcor_gauge_line;

  typedef enum mcor_gauge_state
  {
    MCOR_GAUGE_DRY = 0,  /* no fluid anywhere on the line */
    MCOR_GAUGE_WET = 1,  /* some, but not at the line's end */
    MCOR_GAUGE_FULL = 2, /* fluid at the line's end */
    MCOR_GAUGE_STATE_COUNT
  } mcor_gauge_state;

  /* Of one line; lengths are measured from its beginning, unit L. */
  typedef struct mcor_gauge_reading
  {
    mcor_gauge_state state;
    int outside;             /* 1: no particle's support reaches the line */
    double first, last;      /* where fluid first, and last, ends: at the line's end if it ends nowhere
                              * before; NaN where dry */
    double depth;            /* length of the line in fluid; 0 where dry */
    double place[3];         /* of `last`; NaN where dry */
    int64_t first_crossing;  /* of this line, among all */
    int64_t crossing_count;  /* whichever way the line goes through the surface */
  } mcor_gauge_reading;

  /* Owned; free with mcor_free_gauges. */
  typedef struct mcor_gauges
  {
    int64_t count; /* of lines */
    mcor_gauge_reading* readings; /* [count] */
    int64_t crossing_count;
    double* crossings; /* [crossing_count], ascending for each line, unit L */
    mcor_statistics statistics;
  } mcor_gauges;

  /* Where lines go through the free surface: where the weight sum of fluid particles, as mcor_extract has
   * it for MCOR_WEIGHT_SUM, is the level, which is the iso value; 0.5 without one. Fluid is where it
   * is at least the level, above 0. Walls do not end it. Each line is sampled at a quarter of the smallest (scaled)
   * smoothing length; between samples whose neighbours show that an extremum may cross the
   * level, more finely. Crossings are then solved for. lines: [count]. Options count as for mcor_probe, and
   * iso_values and wall_share; fields, box and globals do not. Of periodic particles the images count.
   * *gauges is overwritten. */
  mcor_status mcor_gauge(mcor_context* context, const mcor_input* input,
    const mcor_options* options, const mcor_gauge_line* lines, int64_t count, mcor_gauges* gauges);
  void mcor_free_gauges(mcor_gauges* gauges);
  const char* mcor_gauge_state_name(mcor_gauge_state state); /* "dry", "wet", "full" */

  typedef enum mcor_gradient
  {
    MCOR_GRADIENT_CORRECTED = 0, /* first-order corrected where its matrix can be inverted, else
                                  * standard; exact for linear attributes up to rounding */
    MCOR_GRADIENT_STANDARD = 1   /* sum_j V_j (A_j - A_i) grad W_ij, W_ij with h_j */
  } mcor_gradient;

  /* SPH gradients at the particles. Owned; free with mcor_free_derivatives. */
  typedef struct mcor_derivatives
  {
    int64_t count;      /* of particles */
    double** gradients; /* [attribute_count] -> [count][components][3]: d component / d axis, per L;
                         * 0 for solid particles */
    uint8_t* corrected; /* [count], 1 where the corrected form was taken */
    int64_t* attribute_not_finite; /* [attribute_count], as in mcor_surface */
    int attribute_count;
    mcor_statistics statistics;
  } mcor_derivatives;

  /* Gradients of the input's attributes. Sums are over fluid particles. Options count as for
   * mcor_probe, but field, gradients and node_threshold. A gradient that is too large for a double is
   * infinite. *derivatives is overwritten. */
  mcor_status mcor_derive(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_gradient form, mcor_derivatives* derivatives);
  void mcor_free_derivatives(mcor_derivatives* derivatives);

  /* What is wanted of velocity gradients J = S + O, S symmetric, O antisymmetric; NULL: not
   * wanted. The caller's arrays, unit of J or its square. */
  typedef struct mcor_flow
  {
    double* divergence;  /* [count], tr J */
    double* vorticity;   /* [count][3], curl */
    double* q_criterion; /* [count], (tr(J)^2 - tr(J J)) / 2 */
    double* lambda2;     /* [count], the middle eigenvalue of S S + O O */
    double* strain_rate; /* [count][3][3], S */
  } mcor_flow;

  /* gradients: [count][3][3], d component / d axis, as in mcor_derivatives. */
  mcor_status mcor_decompose_gradients(
    const double* gradients, int64_t count, const mcor_flow* flow);

  /* Drops all that the context keeps between calls: results for reuse, and large buffers. */
  void mcor_release_memory(mcor_context* context);

#ifdef __cplusplus
}
#endif

#endif
