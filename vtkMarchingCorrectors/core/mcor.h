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
 * Functions that can fail return an mcor_status, MCOR_OK being 0, unless their comments say
 * otherwise; after a failure, outputs are empty and safe to free. The library never prints, never
 * exits and keeps no global state. Only one thread at a time may use a context; several threads may
 * use several contexts at once. A call starts helper threads on the processors that its thread may
 * use. On the built-in device, the helpers wait for the context's next call, and end with the
 * context. On other devices, up to 15 helpers work and up to 12 build programs; all end before the
 * call returns, even if it is cancelled.
 *
 * Lengths are in the unit of the particle positions ("length unit L"). */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif
/* A shared library exports only what its public headers declare. */
#ifdef __GNUC__
#pragma GCC visibility push(default)
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

  /* A code for each sentence of this library; the sentences are the rows of mcor_says.def. */
  typedef enum mcor_says
  {
    MCOR_SAYS_NOTHING = 0,
#define SAYS(code, text) MCOR_SAYS_##code,
#include "mcor_says.def"
    MCOR_SAYS_COUNT
  } mcor_says;

  /* A sentence: a failure or a warning. In the text, a slot such as {cube_size} stands for the name
   * of a member of mcor_options or mcor_input, and one such as {precision double} for an option and
   * its value: see mcor_fill_slots. The caller frees a message with mcor_free_message. */
  typedef struct mcor_message
  {
    mcor_says code; /* MCOR_SAYS_NOTHING: there is no message */
    char* text;     /* NULL without a message, or if memory ran out */
  } mcor_message;
  void mcor_free_message(mcor_message* message);

  /* A function that writes an interface's word for a slot into word [size], such as "--cube-size"
   * for {cube_size}. value: what stands behind the name in the slot, or "". Returns 0 if the
   * interface has no word, else another number. After 0, mcor_member_word gives the word; a slot
   * that names no member stays as it is, with its braces. */
  typedef int (*mcor_word)(
    void* user, const char* name, const char* value, char* word, size_t size);
  /* mcor_member_word gives the words of C, "cube_size" and "precision=double"; mcor_label_word
   * gives the words of panels, "Cube Size" and "Field Precision double". */
  int mcor_member_word(void* user, const char* name, const char* value, char* word, size_t size);
  int mcor_label_word(void* user, const char* name, const char* value, char* word, size_t size);
  /* Returns the text with its slots filled; free it with free(). NULL: memory ran out. If word is
   * NULL, mcor_member_word gives the words. */
  char* mcor_fill_slots(const char* text, mcor_word word, void* user);
  /* Return the code's name, such as "ISO_OUTSIDE", and its text, with printf's formats and with
   * slots; NULL if there is no such code. */
  const char* mcor_says_name(mcor_says code);
  const char* mcor_says_text(mcor_says code);

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
    MCOR_QUARTIC_SPLINE = 5, /* M5, support radius 2.5 */
    MCOR_WENDLAND_C4 = 6,    /* support radius 2 */
    MCOR_WENDLAND_C6 = 7,    /* support radius 2 */
    MCOR_SINC_6 = 8,         /* (sin x / x)^6, x = pi q / 2, support radius 2 */
    MCOR_SPH_KERNEL_COUNT
  } mcor_sph_kernel;

  /* The field to contour. V: particle volume, A: scalar, W: kernel. */
  typedef enum mcor_field
  {
    MCOR_SHEPARD = 0,   /* sum V A W / sum V W; the default */
    MCOR_SUM = 1,       /* sum V A W, the paper's field; 0 in all empty space, so iso value 0 with
                         * node threshold 0 gives no sensible surface */
    MCOR_WEIGHT_SUM = 2 /* sum V W: the free surface; needs no scalar and applies no threshold */
  } mcor_field;

  typedef enum mcor_seed_mode
  {
    MCOR_COMPLETE = 0, /* examines every cell that a bound cannot exclude; misses nothing */
    /* The paper's seeds, for comparisons: the cells between two particles whose values lie on
     * different sides of the iso value, and whose distance is at most the larger of their
     * (unscaled) smoothing lengths. Needs cubes of one size, and no box, caps or ranks. With
     * MCOR_WEIGHT_SUM particles have no values, so seeds are complete. */
    MCOR_PAIRS = 1
  } mcor_seed_mode;

  /* How nodes are connected inside a cell, and on an ambiguous face, where two nodes at opposite
   * corners are above the iso value and two are below. Both ways give the same vertices, and a
   * manifold. */
  typedef enum mcor_topology
  {
    MCOR_TOPOLOGY_TABLE = 0, /* nodes above the iso value are kept apart on such faces, and no cell
                              * has a tunnel */
    MCOR_TOPOLOGY_FIELD = 1  /* the field decides, at the saddles of the face's bilinear and the
                              * cell's trilinear interpolant: bridges and tunnels as wide as a cube
                              * are those of the field */
  } mcor_topology;

/* Levels of cubes, 0 to 24. Cubes of level L have edges of 2^L cube sizes. A brick of 4^3 cubes has
 * level L only if all particles that reach the brick have at least 2^L times the smallest smoothing
 * length. Bricks that touch differ by one level at most. The surface is closed across levels. If
 * all particles have the same smoothing length, all cubes have level 0. With MCOR_TOPOLOGY_FIELD,
 * the field decides only in cubes and on faces that no finer cube touches. A period is a whole
 * number of the largest bricks; this may limit the level, see mcor_statistics.highest_level. */
#define MCOR_CUBE_LEVELS 25

  /* Which sides caps close, see mcor_options.capping. */
  typedef enum mcor_capping
  {
    MCOR_CAP_NONE = 0,   /* the default */
    MCOR_CAP_PERIOD = 1, /* the sides of the period */
    MCOR_CAP_BOX = 2     /* the sides of the period and of the box */
  } mcor_capping;

  /* The quantity by which trimming tells where the fluid ends: about 1 inside, without a unit. */
  typedef enum mcor_boundary_detection
  {
    MCOR_BOUNDARY_WEIGHT_SUM = 0, /* the trimming weight sum V W; the default */
    /* The smallest eigenvalue of the symmetric part of the matrix sum V (x_j - x) (outer product)
     * grad W(x - x_j), over the particles that the trimming weight counts. This matrix is the
     * inverse of the renormalisation matrix (Marrone et al. 2010). Set vertex_threshold, too: 0.3
     * trims about where a weight of 0.5 does; 0.75 trims 0.9 smoothing lengths inside a flat
     * surface. Near 0.5 the border is ragged. */
    MCOR_BOUNDARY_EIGENVALUE = 1
  } mcor_boundary_detection;

  /* A per-particle quantity, or one constant for all particles. */
  typedef struct mcor_array
  {
    /* [count][components]. Values must be finite, except in attributes, and where mcor_input.solid
     * says otherwise. Not copied: keep the data until the call returns. NULL: the values are in
     * `memory` or, if `memory` is NULL, too, all equal to `constant`. */
    const void* data;
    mcor_type type;
    int components;   /* 1 unless said otherwise; 0 is read as 1 */
    double constant;  /* the value of all particles where data and memory are NULL */
    const char* name; /* for messages; may be NULL */

    /* For programs with an OpenCL context of their own: a cl_mem of any context, which holds the
     * values if data is NULL. The values of the first particle begin at byte `offset`, the values
     * of each next particle `stride` bytes later; stride 0: values are packed. Calls on a
     * mcor_context map such arrays of mcor_input for reading. On a CPU nothing is copied if values
     * are packed and `offset` is a multiple of a number's size; from a GPU the values pass through
     * the host, which checks and measures all particles. Commands that write to the memory must
     * have finished. `memory` is read only in arrays of mcor_input, and only by functions with a
     * context. mcor_store writes results to such memory. */
    void* memory;
    size_t offset, stride;
  } mcor_array;

  /* Whether the array has data or memory, or a constant other than 0. */
  int mcor_is_given(const mcor_array* array);

#define MCOR_MAGNITUDE (-1)
/* A value in mcor_input.solid: the particle is left out of everything. */
#define MCOR_ABSENT 2

  typedef struct mcor_input
  {
    int64_t count;        /* number of particles; 0 gives an empty surface */
    mcor_array positions; /* [count][3], length unit L; data or memory must be given */

    /* Smoothing length, unit L, > 0; or the kernel's support radius, if
     * smoothing_length_is_support_radius is set. With estimate_smoothing_length the array is not
     * read, and one smoothing length, 1.3 times the median particle spacing, is used for all
     * particles. */
    mcor_array smoothing_length;
    int smoothing_length_is_support_radius;
    int estimate_smoothing_length;

    /* Factors of the smoothing lengths, at least 1, as mcor_widen makes them; not given: 1. Kernels
     * use smoothing length x factor; cubes, their levels and the statistics use the smoothing
     * length. Volumes must be given: if they would be computed, give the volumes that mcor_widen
     * returns. To have the factors on the surface, make them an attribute, too. */
    mcor_array widening;

    /* Particle volume, unit L^3, > 0: `volume` if given (mcor_is_given); else mass / density if
     * both are given; else, with mass alone, m_j / (F_j sum_k m_k W(x_j - x_k, h_j)); else 1 / (F_j
     * sum_k W(x_j - x_k, h_j)). The sums are low where a particle has no neighbours on one side;
     * F_j makes up for this. F_j is 1 for solids, else 1 + 5/3 D^2, with D = s h_j |g| / n. n is
     * sum_k h_k^d W(x_j - x_k, h_j), d the dimension, and s h_j the kernel's standard deviation
     * along an axis. g is the gradient of n. The solids' part of g is multiplied by the factor from
     * 0 to 1 that makes |g| least, as solids fill a side without neighbours. All sums leave out
     * ignored solids; for MCOR_WEIGHT_SUM, they leave out all solids unless the free surface ends
     * at solids. So computed volumes next to walls differ between the fields. */
    mcor_array volume, mass, density;

    /* The scalar A to contour; not read for MCOR_WEIGHT_SUM. If it has 2 or more components,
     * scalar_component selects one of them, MCOR_MAGNITUDE the Euclidean norm. If scalar_dot has
     * data or memory, A is the dot product of `scalar` and scalar_dot, which must have equally many
     * components. Values above about 1e30 need double precision; values above 1e290 need another
     * unit. */
    mcor_array scalar;
    int scalar_component;
    mcor_array scalar_dot;

    /* [count], borrowed; nonzero: a solid (wall) particle. NULL: all particles are fluid. Solid
     * particles never take part in the field. They count in the weight used for trimming unless
     * ignore_solids is set; the surface may end at them, see mcor_options.wall_share. MCOR_ABSENT:
     * the particle is left out of everything. Arrays may hold NaN for absent particles, and for
     * solids that play no part, because these values are not used. */
    const uint8_t* solid;
    int ignore_solids;

    /* Other arrays to interpolate to the surface (Shepard mean of fluid particles). An array that
     * is not finite at a fluid particle is left out, see attribute_not_finite. */
    const mcor_array* attributes; /* [attribute_count] */
    int attribute_count;

    /* Reuse: equal nonzero numbers in two successive calls promise that the following is the same:
     * positions, smoothing lengths, their factors, volumes and solids (particles_version), the
     * scalar (scalar_version), or all attributes (attributes_version; mcor_probe keeps them on the
     * device). Reuse saves time and never changes the result. 0: never reuse. */
    uint64_t particles_version;
    uint64_t scalar_version;
    uint64_t attributes_version;
  } mcor_input;

/* The default wall share: measured for the surface of a scalar, none for the free surface. */
#define MCOR_WALL_SHARE_AUTO (-2)

/* The wall share is measured: at a sample of the solids, the solids' share of the weight is
 * computed, and the wall share is the median of these shares, weighted by the fluid's weight at
 * each solid. The surface of a scalar then ends on the layer of solids that faces the fluid,
 * however many layers there are and whatever their distance from the fluid. For the free surface
 * the wall share is 0.5, and the surface stays in front of that layer. */
#define MCOR_WALL_SHARE_MEASURED (-1)

  /* These types serve surfaces that are made in parts or by several processes: see mcor_parts.h. */
  typedef struct mcor_globals mcor_globals;
  typedef struct mcor_ranks mcor_ranks;

  /* Arrays that a surface may have besides points and triangles, named after the members of
   * mcor_surface. Samples can have only the arrays of MCOR_OUT_GRADIENTS. */
  typedef enum mcor_output
  {
    MCOR_OUT_NORMALS = 1,
    MCOR_OUT_GRADIENTS = 2,
    MCOR_OUT_WEIGHT_SUM = 4,
    MCOR_OUT_BOUNDARY_EIGENVALUE = 8,
    MCOR_OUT_CORRECTION_LENGTH = 16,
    MCOR_OUT_RESIDUAL = 32,
    MCOR_OUT_BOUNDARY_FLAG = 64,
    MCOR_OUT_ISO_VALUE = 128,
    MCOR_OUT_NEAREST_PARTICLE = 256,
    MCOR_OUT_POINT_KEYS = 512,    /* see MCOR_POINT_KEY */
    MCOR_OUT_MEAN_CURVATURE = 1024,
    MCOR_OUT_GAUSS_CURVATURE = 2048, /* not in two dimensions */
    MCOR_OUT_TRIANGLE_KEYS = 4096    /* see MCOR_TRIANGLE_KEY */
  } mcor_output;

  typedef struct mcor_options
  {
    /* 2: x, y or z is exactly the same for all particles, so they lie in a plane; sums are
     * two-dimensional (volumes are areas, masses are per unit of depth), and lines are extracted in
     * place of a surface. 0 (the default): 2 if exactly one coordinate is the same for
     * all particles, else 3; see mcor_statistics.dimension. In the plane, squares take the place of
     * cubes, and a period along the constant axis is ignored. */
    int dimension;
    mcor_sph_kernel sph_kernel;
    mcor_field field;
    mcor_seed_mode seeds;
    mcor_topology topology;
    /* 1 to 4; default 1: off. The greatest factor that mcor_widen finds for the smoothing length of
     * a particle. mcor_extract takes these factors from mcor_input.widening, which must be given if
     * `widen` is not 1. */
    double widen;
    double h_scale;          /* the kernel uses h_scale * smoothing length; volumes do not change */
    double cube_size_factor; /* cube size = factor * smallest smoothing length; default 0.5 */
    double cube_size;        /* unit L; > 0 overrides the factor */
    /* Highest level of cubes, see MCOR_CUBE_LEVELS; 0: uniform cubes; default 24. mcor_probe and
     * mcor_derive do not read it. */
    int level_limit;
    /* [iso_count], finite, above 0 with MCOR_WEIGHT_SUM; iso_count 0: an empty surface */
    const double* iso_values;
    int iso_count;
    /* Cells with a node whose weight is below this are discarded; default 0.1. With MCOR_SHEPARD,
     * cells with a node whose fluid weight is below 0.001 are discarded, too. */
    double node_threshold;
    mcor_boundary_detection boundary_detection;
    /* Triangles are trimmed where the weight (or the boundary eigenvalue) is below this; default
     * 0.5. With MCOR_SHEPARD they are always trimmed where the fluid's own weight is below 0.001,
     * or below 0.05 with M'4, whose negative lobes may cancel the weight that the mean divides
     * by. */
    double vertex_threshold;
    /* If above 0, any surface, even a free surface, also ends where the solids' share of the weight
     * exceeds this, unless solids are ignored. 0.5: it ends where solids weigh more than the fluid.
     * 0: it does not end at solids. MCOR_WALL_SHARE_AUTO is the default, MCOR_WALL_SHARE_MEASURED
     * another choice. */
    double wall_share;
    int preview; /* nonzero: vertices by linear interpolation, no correction */
    /* In two dimensions, nonzero: triangles fill the region above the lowest iso value within the
     * trimmed fluid; the lines of the other values divide it into bands, see
     * mcor_surface.band_value. The triangles share the points of the lines; their other points are
     * nodes of the virtual grid and points where trimming cuts its edges. The array iso_value is
     * returned even without MCOR_OUT_ISO_VALUE. Seeds are complete, and all squares have the
     * smallest size. In three dimensions this is an error. */
    int filled;
    /* Nonzero: a compact contour, with a quarter fewer triangles and hardly any slivers. Vertices
     * that belong to one node of the virtual grid, and that edges of triangles join, are merged.
     * The merged vertex moves onto the surface along the gradient, not along a lattice edge.
     * Nothing is merged where this would join or split pieces of the surface. A merge is undone if
     * the vertex does not reach the surface, or if a triangle turns over. The widest corner of each
     * remaining sliver moves to the middle of its neighbours, and from there onto the surface.
     * Points on the sides of periods, at caps and on borders do not change. Cannot be combined with
     * `filled`. */
    int compact;
    int smooth; /* nonzero: for pictures; mcor_spell_out sets what this stands for */
    double tolerance;    /* |f - iso| reached by the correction / range of A; default 1e-6 */
    int iteration_limit; /* of the correction, per vertex; 1 to 255, default 30 */
    mcor_type precision; /* of the field evaluation on the device; MCOR_FLOAT32 by default */
    /* The most bytes of device memory that may be in use or kept for reuse, >= 0; 0: no limit. Kept
     * memory is freed before a run fails for lack of memory. */
    int64_t memory_limit;

    /* x0, x1, y0, y1, z0, z1; unit L. Unless all are 0, the result is the part of the surface in
     * cells whose centres are in the box, box[2 a] <= x < box[2 a + 1] along axis a. It has the
     * same bits as the whole surface, and boxes side by side make up the whole surface. Sides may
     * be infinite. A box may be flat (y0 = y1) only around particles in the plane y = y0. Lattice,
     * ranges and smallest h are measured over all particles; only particles that reach the box are
     * evaluated. mcor_probe and mcor_derive read the box only with globals. */
    double box[6];

    /* x0, x1, y0, y1, z0, z1; unit L. Where x0 < x1, the particles repeat along x with the period
     * x1 - x0: each is moved to its place between x0 and x1, and its images count. The surface is
     * that of one period, and open at the periodic sides. Its points on opposite sides agree in all
     * bits, except for the rounded coordinate along the period. Each period is a whole number of
     * cubes: the cube size is reduced to fit, by less than half. A box may lie across the sides of
     * a period: the period is then moved, see mcor_move_period. x0 = x1 (default 0): not periodic.
     * mcor_probe and mcor_derive read the period, too; a probe's points may lie anywhere. */
    double periodic[6];
    /* MCOR_CAP_PERIOD: flat triangles close the surface at the periodic sides, where values are
     * above the iso value; with a box, they close those sides of its cells that lie on a periodic
     * side. MCOR_CAP_BOX: triangles also close the other sides of the box's cells (with ranks: of
     * whole_box). Caps share the points of the surface's border; their other points are nodes, with
     * normals pointing out of the period or box, boundary flag 8, and a meaningless residual.
     * Trimming also cuts caps. The trimmed border stays open, and so does the border at solids (see
     * wall_share). With caps, all cubes have the smallest size. A box that no particle reaches gets
     * no caps, even if the field is a sum and the iso value is 0. In two dimensions, straight lines
     * along these sides close the contour, and end exactly where trimming cuts them; lines that end
     * at walls stay open. Caps cannot be combined with MCOR_PAIRS or with `filled`. */
    int capping; /* mcor_capping */

    /* NULL: lattice and ranges are measured over the input. Otherwise the result of
     * mcor_measure_globals for all particles. The input then needs only the particles whose
     * supports miss the box by no more than mcor_reach_margin; with computed volumes, also all
     * particles within the (unscaled) supports of these particles. The surface has the same bits as
     * with all particles. Borrowed until return. mcor_probe and mcor_derive take the result of
     * mcor_measure_probe_globals instead. Their results are valid in the box and on its sides;
     * elsewhere, they are meaningless, or 0 for particles two cubes or more away from the box. */
    const mcor_globals* globals;

    /* NULL: this process alone. Otherwise mcor_measure_globals and mcor_measure_probe_globals
     * measure over the inputs of all ranks; each particle must be in exactly one of the inputs. (A
     * rank without particles has count 0, and data that are not NULL where the other ranks have
     * data.) The result has the same bits as for all particles in one input, except for
     * attribute_not_finite: this is the least index that a NaN or infinity has on its own rank.
     * mcor_extract needs these globals; each cell must be in the box of exactly one rank. A
     * function whose comment does not mention ranks ignores this member. Borrowed until return. */
    const mcor_ranks* ranks;

    /* Arrays that the surface carries besides points and triangles. */
    unsigned outputs;     /* bits of mcor_output; default MCOR_OUT_NORMALS */
    int triangle_normals; /* normals by area-weighted triangle normals instead of the gradient */

    /* The phase text that `progress` gets while a driver builds programs, which may take a minute.
     * If the remaining time is known, ", about 5 s to come" follows. Programs of the built-in
     * device are compiled beforehand. */
#define MCOR_BUILDING "building the OpenCL program (first time only)"
    /* Called between device launches. fraction: how much of the work is done, 0 to 1; phase: a text
     * that tells what is being done. If the return value is nonzero, the call stops with
     * MCOR_CANCELLED. May be NULL. */
    int (*progress)(void* user, double fraction, const char* phase);
    void* progress_user;
  } mcor_options;

  /* Phases, in the order in which they run. */
  typedef enum mcor_phase
  {
    MCOR_PHASE_INPUT = 0,   /* checks, unit conversion, transfer to the device */
    MCOR_PHASE_SEARCH_GRID, /* search grid and volumes */
    MCOR_PHASE_SEEDS,       /* seed selection, evaluation of nodes */
    MCOR_PHASE_EXTRACTION,  /* marching cubes; MCOR_TOPOLOGY_FIELD: evaluation of samples */
    MCOR_PHASE_CORRECTION,  /* Newton iteration, normals, attributes */
    MCOR_PHASE_TRIMMING,    /* trimming, caps, compact contours */
    MCOR_PHASE_OUTPUT, /* compaction and transfer to the host */
    MCOR_PHASE_COUNT
  } mcor_phase;

  typedef struct mcor_statistics
  {
    double seconds[MCOR_PHASE_COUNT];
    double build_seconds; /* compiling or loading kernels, in any phase; not part of `seconds` */
    int64_t fluid_particles, solid_particles;
    /* far_particles: how many particles are left out because they are too far away from all others
     * for the virtual grid (at most 0.1 % of all, or 8 if that is more). far_first, far_place:
     * index and position of the first particle that is left out. */
    int64_t far_particles, far_first;
    double far_place[3];
    /* How many fluid particles would have no free surface if they were alone: a particle's volume
     * times W(0), which is its own part of the weight sum, is below the lowest iso value. 0 if
     * volumes are computed, or if a scalar is contoured. */
    int64_t lone_particles;
    /* The number of particles on the device. Periodic images count, too. With a box, the device has
     * only the particles that the box needs. */
    int64_t particles_in_reach;
    double smoothing_length_min, smoothing_length_max; /* of fluid particles, unit L, unscaled */
    /* Medians over a sample of the fluid particles. smoothing_length_median: unit L, unscaled.
     * neighbours_median: how many particles are within the unscaled support radius, including the
     * particle itself and solids. spacing_median: distance of the nearest other particle; 0: there
     * is none. filled_median: the share of the support that these neighbours fill if all are as
     * large as the particle itself; 0 if volumes are computed. */
    double smoothing_length_median, neighbours_median, spacing_median, filled_median;
    double widening_min, widening_mean, widening_max; /* factors of fluid particles, or 0 */
    /* How many fluid particles mcor_widen puts outside of the surface: their weight sum is at least
     * the iso value with their own smoothing lengths, but below it if these lengths are multiplied
     * by the widening factors. In a box, mcor_widen also counts particles next to the box. */
    int64_t widening_outside;
    double wall_share;      /* in use; 0: the surface does not end at solids */
    double fluid_extent[3]; /* of the positions of fluid particles, along x, y, z */
    double plane_normal[3]; /* of a plane that all particles are near, in three dimensions; or 0 */
    double plane_extent;    /* of the positions of all particles, along plane_normal */
    int dimension;          /* 2 or 3, see mcor_options.dimension */
    double cube_size;       /* unit L; the shortest of cube_edges */
    double cube_edges[3];   /* along x, y, z: unequal where no cube size divides all periods */
    double scalar_min, scalar_max; /* over fluid particles; 0 and 1 with MCOR_WEIGHT_SUM */
    /* With a box, the lattice and all counts of cells, triangles and vertices are for the box
     * alone; a vertex that ranks share is counted by one of them. Counts of bricks, nodes, faces
     * and evaluations include the work done around the box. */
    int64_t lattice_origin[3]; /* lowest node of the virtual grid: world position / edge */
    int64_t lattice_cells[3];
    int64_t virtual_cells; /* product of lattice_cells, below 2^63 */
    /* seed_cells: the cells where the search for the surface begins. With complete seeds and
     * uniform cubes: all cells, except where a bound of the field excludes a surface. With complete
     * seeds and adaptive cubes: the cells of leaves (undivided bricks of cubes) through which the
     * surface passes. With pair seeds: the cells between the two particles of each pair.
     * seed_cells_not_intersected: how many of the seed cells the surface does not use. These counts
     * and most of the following ones are summed over iso values. */
    int64_t seed_cells, seed_cells_not_intersected;
    /* Counted after the last iso value, not summed over iso values: bricks that exist, and nodes
     * that have values, some of them from earlier calls. */
    int64_t bricks, nodes_evaluated;
    int64_t cells_used; /* intersected cells of the surface, before trimming */
    int64_t triangles_before_trimming;
    int64_t cap_triangles; /* not included in triangles_before_trimming */
    /* Measures of the returned surface. is_closed: nonzero if each edge has triangles on both
     * sides; in two dimensions, if all lines are closed. area: unit L^2; in two dimensions the area
     * of the filled region, or the area that the lines enclose, 0 if they are not closed. volume:
     * unit L^3, what a closed surface encloses, without cavities; negative if values grow outwards;
     * 0 if the surface is not closed. length: of the lines, unit L. */
    int is_closed;
    double area, volume, length;
    int64_t march_rounds;
    /* With adaptive cubes: the number of used cells of each level, and the number of triangles,
     * before trimming, in the cells of each level. */
    int64_t cells_of_level[MCOR_CUBE_LEVELS], triangles_of_level[MCOR_CUBE_LEVELS];
    /* How many polygons of the surface lie in one face of a cell, beside finer cells. At such a
     * face, the cell cuts off a part of the surface that the finer cells resolve. */
    int64_t flat_loops;
    int highest_level; /* allowed by the smoothing lengths, level_limit and periods */
    /* All 0 without MCOR_TOPOLOGY_FIELD. joined_faces: ambiguous faces on which the field connects
     * the two nodes above the iso value (MCOR_TOPOLOGY_TABLE keeps them apart on all ambiguous
     * faces). ambiguous_cells: cells in which a tunnel may join two polygons of the surface.
     * tunnels: cells in which a tunnel joins them. */
    int64_t ambiguous_faces, joined_faces, ambiguous_cells, tunnels;
    /* Mean, greatest value and standard deviation of the distance between a linearly interpolated
     * vertex and the corrected vertex, unit L, as in the paper's Table V. */
    double correction_mean, correction_max, correction_deviation;
    int64_t correction_count; /* vertices in the mean: all but trim vertices and points of caps */
    int64_t vertices_corrected, newton_evaluations, vertices_above_tolerance;
    double iterations_mean;
    int iterations_max;
    /* Greatest |f - iso| at a vertex, in the scalar's unit, without caps and trim_vertices_linear.
     * |f - iso| is as evaluated on the device, plus the most that the device's rounding of
     * positions and sums may add. */
    double residual_max;
    double position_error; /* largest rounding of positions on the device, unit L */
    int64_t trim_vertices, trim_vertices_linear; /* linear: with boundary flag 2 */
    int64_t device_bytes_peak;
    char device[128], platform[128];
  } mcor_statistics;

  /* The key of a point is three numbers. The first tells the number of the iso value and the kind
   * of the point; the other two tell the place: for a point on a lattice edge, this edge; for a
   * cut, which trimming makes, the lattice edges of the two points between which the cut lies; for
   * a point that only a cap has, a square of the cap, and a number. A merged point (see
   * mcor_options.compact) has the key of the first of the points that it replaces. The points of a
   * surface have different keys, in ascending lexicographic order. In the surface of a box, points
   * have the same keys as in the whole surface. */
#define MCOR_POINT_KEY 3

  /* The key of a triangle is two numbers: the number of the iso value, then the key of the cell, or
   * of the cap's square, in which the triangle lies. Triangles are in the order of their keys;
   * triangles of one cell have the same key. In the surface of a box, triangles have the same keys
   * as in the whole surface. Each cell is in one box, so a stable sort by key of the triangles of
   * all boxes gives the whole surface's order. */
#define MCOR_TRIANGLE_KEY 2

  /* A triangle mesh. Triangles share vertices. The normal of a triangle (right-hand rule) points to
   * lower values of the field, as with vtkContourFilter. Free it with mcor_free_surface. */
  typedef struct mcor_surface
  {
    int64_t point_count, triangle_count;
    double* points;          /* [point_count][3], unit L */
    int32_t* triangles;      /* [triangle_count][3], point indices */
    uint64_t* triangle_keys; /* [triangle_count][MCOR_TRIANGLE_KEY]; NULL where not asked for */
    /* In two dimensions, a surface has polylines; with `filled`, also the triangles of the filled
     * region. Line l has the points line_points[line_offsets[l]] to line_points[line_offsets[l + 1]
     * - 1]. Values are greater on the line's left, seen from the positive end of the constant axis.
     * A closed line ends with its first point. Open lines come first. Normals lie in the plane, but
     * with `filled`, all normals are along the constant axis. Statistics that count triangles count
     * each part of a line between two points. Lines have no triangle_keys. */
    int64_t line_count, line_point_count;
    int64_t* line_offsets; /* [offset_count] = line_count + 1; NULL in three dimensions */
    int32_t* line_points;  /* [line_point_count], point indices */
    /* [triangle_count]; NULL unless `filled`. The iso value at which the band of each triangle
     * begins; the last band has no upper end. At nodes inside the region, iso_value is the value at
     * which the node's band begins, and residual is the field minus iso_value. */
    double* band_value;
    /* Optional arrays, see mcor_output; NULL where not asked for. */
    float* normals;             /* [point_count][3], unit length, towards lower values */
    double* gradients;          /* [point_count][3], gradient of the field, scalar unit / L */
    float* weight_sum;          /* [point_count], the trimming weight */
    float* boundary_eigenvalue; /* [point_count], see MCOR_BOUNDARY_EIGENVALUE */
    float* correction_length;   /* [point_count], unit L */
    float* residual;            /* [point_count], f - iso, scalar unit */
    /* [point_count]; 0: inside; 1: on the trim boundary: there the weight (or eigenvalue) equals
     * the vertex threshold, or the solids' share of the weight equals the wall share; 2: on the
     * trim boundary by linear interpolation only, because the exact place was not found; 4: on a
     * lattice edge next to a cell that the node threshold discarded; 8: belongs to a cap alone, see
     * capping, or is a node inside the filled region. */
    uint8_t* boundary_flag;
    double* iso_value;         /* [point_count] */
    int64_t* nearest_particle; /* [point_count], index of the nearest fluid particle */
    uint64_t* point_keys;      /* [point_count][MCOR_POINT_KEY] */
    /* [point_count], unit 1 / L and 1 / L^2, from the first and second derivatives of the field. On
     * a sphere of radius R, they are 1 / R (-1 / R where the field is lower inside) and 1 / R^2. In
     * two dimensions the mean curvature is the line's curvature, 1 / R for a circle. On caps both
     * are meaningless. */
    double *mean_curvature, *gauss_curvature;
    double** attributes;       /* [attribute_count] -> [point_count][components] */
    /* [attribute_count]; the index of the first fluid particle at which the attribute is NaN or
     * infinite; -1: there is none. An attribute with such a particle is left out; its entry in
     * `attributes` is NULL. */
    int64_t* attribute_not_finite;
    int attribute_count;
    mcor_statistics statistics;
  } mcor_surface;

  typedef struct mcor_context mcor_context;

  /* device: a number as listed by mcor_list_devices, or part of the name of a device or platform.
   * NULL or "": the environment variable MCOR_DEVICE names the device in this way; if it is not
   * set, the default is taken (the built-in device if it can do the run, else a GPU, else another).
   * On failure *context is still a context, whose mcor_last_error says why (NULL only if host
   * memory ran out). */
  mcor_status mcor_create_context(const char* device, mcor_context** context);
  void mcor_free_context(mcor_context* context);

  /* Lists the devices, each in a line "number: device (platform)\n". The built-in device comes
   * first; its line names no platform. *text is empty if there is no device, and NULL if memory ran
   * out. Free it with free(). */
  mcor_status mcor_list_devices(char** text);

  /* Returns a sentence that tells why the last failed call on this context failed; "" if none
   * failed. Slots for the names of options, such as {cube_size}, are filled with the names in C.
   * Valid until the next call on the context. */
  const char* mcor_last_error(const mcor_context* context);
  /* Returns the sentence of mcor_last_error and its code; slots such as {cube_size} are not filled.
   * Free the message with mcor_free_message. */
  mcor_message mcor_last_message(const mcor_context* context);
  const char* mcor_status_name(mcor_status status);
  const char* mcor_phase_name(mcor_phase phase); /* "search grid", "seeds", ... */

  /* mcor_find_sph_kernel returns the kernel with a short name ("cubic", "wendland", ...); -1: there
   * is none. mcor_sph_kernel_name returns the short name of a kernel; NULL: there is none. */
  int mcor_find_sph_kernel(const char* name);
  const char* mcor_sph_kernel_name(mcor_sph_kernel kernel);
  double mcor_support_factor(mcor_sph_kernel kernel); /* support radius / smoothing length */

  /* The quantity that an array of particles holds, judging by its name. */
  typedef enum mcor_quantity
  {
    MCOR_SMOOTHING_LENGTH = 0,
    MCOR_VOLUME,
    MCOR_MASS,
    MCOR_DENSITY,
    MCOR_VELOCITY,
    MCOR_PARTICLE_ID,   /* a whole number that identifies the particle at all times */
    MCOR_PARTICLE_TYPE, /* tells fluid from solids */
    MCOR_SPACING,       /* distance of particles; only suggests a smoothing length */
    MCOR_POSITION,      /* columns of a table, three to a position */
    MCOR_QUANTITY_COUNT
  } mcor_quantity;

  /* Returns 0 for the most usual name of the quantity, a higher number for less usual ones, -1 for
   * any other name. Case, blanks, "_" and "-" do not matter. */
  int mcor_name_priority(mcor_quantity quantity, const char* name);

  /* Whether a table's column of this name holds whole numbers that tell particles, or their kinds,
   * apart: the name ends in "id", "type", "index", ... */
  int mcor_tells_apart(const char* name);

  /* Returns an array's priority number. If the user has chosen no array, show the one with the
   * lowest number. Velocities come first, then other vectors, scalars, particle properties, and the
   * rest. -1: do not show the array, because it holds particle ids or types, or does not vary
   * (`varies`: any component has two different values). */
  int mcor_view_priority(const char* name, int components, int is_real, int varies);

  /* A numeric array of a particle file's field data: the components of all its tuples, one after
   * the other. */
  typedef struct mcor_field_data
  {
    const char* name;     /* may be NULL */
    const double* values; /* [count]; borrowed until return */
    int64_t count;
  } mcor_field_data;

  /* Finds the period in an array of field data: PeriodicBounds, BoxSize (GADGET, SWIFT), or `box`,
   * if an array boundaryType marks axes as periodic (SPH-EXA). Case, blanks, "_" and "-" of names
   * do not matter. Returns how many numbers tell the period: 6 bounds, as in mcor_options.periodic;
   * 3 lengths, see mcor_place_period; 0 if no array gives a period. which: becomes the index of the
   * array, or -1; may be NULL. */
  int mcor_find_period(const mcor_field_data* arrays, int count, double period[6], int* which);

  /* Finds the bounds of a period of known lengths. Along each axis, the period begins at 0 if it
   * then contains all particles; else it is centred at 0 if it then contains them; else it begins
   * at the lowest particle. extent: bounds of the particles' positions, x0, x1, y0, ... */
  void mcor_place_period(const double lengths[3], const double extent[6], double bounds[6]);

  /* Whether mcor_find_period reads arrays of this name. */
  int mcor_tells_of_period(const char* name);

  /* Whether the options have a box. */
  int mcor_has_box(const mcor_options* options);

  /* Sets every option to its default; iso_values stays empty. */
  void mcor_set_default_options(mcor_options* options);
  /* If `smooth` is set, sets `compact` unless `filled` is set, and sets `widen` to 2 if it is 1.
   * Call it when the options are complete: without this call, mcor_widen and mcor_extract fail if
   * `smooth` is set. */
  void mcor_spell_out(mcor_options* options);

  /* Extracts the surface. *surface is overwritten; free what it held before the call. */
  mcor_status mcor_extract(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_surface* surface);
  void mcor_free_surface(mcor_surface* surface);

  /* Writes an array of a result, from->data [count][components], to an OpenCL buffer, to->memory,
   * with the type, offset and stride of `to`; bytes between the values stay. If both types are the
   * same, bytes are copied, so that whole numbers may pass as floats of their size. The array is
   * written when the call returns. Fails with MCOR_INVALID_ARGUMENT if the buffer is too small, or
   * if the numbers of components differ. */
  mcor_status mcor_store(
    mcor_context* context, const mcor_array* from, int64_t count, const mcor_array* to);

  /* Finds the range of the finite values of the scalar at fluid particles, and suggests an iso
   * value: the median (one of the values). If the median is at an end of the middle 90 % of the
   * values, the suggestion is the middle of these 90 %, or of the range if these values are all
   * equal. If all values are positive, and all but the lowest and highest 2 % span at least three
   * decades (but no more than six if the median is at an end), the suggestion is the logarithmic
   * middle of these 96 %. Reads only the scalar and the solids of the input, of all ranks unless
   * `ranks` is NULL. Returns 0 and changes nothing if no value is finite, if mcor_extract would
   * refuse the form of the scalar, or if another rank failed. */
  int mcor_find_iso_value(
    const mcor_input* input, const mcor_ranks* ranks, double range[2], double* iso_value);

  /* Returns 2 or 3, the dimension of a call with this input and this mcor_options.dimension. Reads
   * only the positions and the solids, of all ranks unless `ranks` is NULL. */
  int mcor_find_dimension(const mcor_input* input, const mcor_ranks* ranks, int dimension);

  /* Returns whether the free surface is what users want to see first. Returns 0 for a gas that
   * fills its bounds: 98 % of their volume is within about a smoothing length of a particle.
   * Returns 1 if there are solids or no fluid, if the fluid leaves room within its bounds, or if it
   * is a liquid: it has one smoothing length, and densities that differ by no more than a factor of
   * 2. Reads positions, solids, smoothing lengths and densities, of all ranks unless `ranks` is
   * NULL; their form must be valid. */
  int mcor_has_free_surface(const mcor_input* input, const mcor_ranks* ranks);

  /* The usual `eta` of mcor_find_smoothing_lengths, which sets the number of neighbours. */
#define MCOR_USUAL_ETA 1.3

  /* Finds smoothing lengths [count] by neighbours, as Phantom, GADGET and SWIFT have them: the h_i,
   * unit L, that solve h_i^d sum_j W(x_i - x_j, h_i) = eta^d, to 1e-6 of h_i; d is the dimension.
   * The sum goes over all particles that play a part, fluid and solid, j = i included. Only the
   * first `count` particles get a length; the others, such as particles of other ranks, are
   * neighbours only. Particles that play no part get 0. No length exceeds the extent of all
   * particles. Reads positions and solids of the input, and sph_kernel, dimension, periodic and
   * ranks of the options. Fails with M'4, whose sum does not grow with h. *why: why the call
   * failed; no message if it did not.
   * With ranks, each particle is among the first `count` of one rank. Its length has the same bits
   * as in one process if this rank has all particles and images within 1.25 times the particle's
   * support radius. If some neighbours are missing, the length is too long. */
  mcor_status mcor_find_smoothing_lengths(const mcor_input* input, const mcor_options* options,
    double eta, int64_t count, double* lengths, mcor_message* why);

  /* Sums densities [count] from masses: sum_j m_j W(x_i - x_j, h_i), unit of mass / L^d, over the
   * same particles as mcor_find_smoothing_lengths. Reads positions, masses, solids, and smoothing
   * lengths [count] of the input, and the same options. Each rank must have all particles within
   * the support radii of its first `count` particles. */
  mcor_status mcor_sum_densities(const mcor_input* input, const mcor_options* options,
    int64_t count, double* densities, mcor_message* why);

  /* Returns the least smoothing length of fluid particles, as the input has it. Returns 1 with
   * estimate_smoothing_length, infinity without fluid. */
  double mcor_least_smoothing_length(const mcor_input* input);

  /* Returns about how many cubes (in a plane: squares) of the virtual grid the fluid fills, in the
   * box if there is one. A particle fills (h / 1.3)^3, in a plane (h / 1.3)^2. Returns 0 without
   * fluid, or if the smoothing length is to be estimated but options.cube_size is given, because
   * the ratio of the two is then not known. least: what mcor_least_smoothing_length returns; of
   * several ranks, the least. The sum of the ranks' results is the number for all ranks. */
  double mcor_estimate_cells(const mcor_input* input, const mcor_options* options, double least);

  /* Returns a warning that a run of `cells` cells may take long; no message if it will not. */
  mcor_message mcor_describe_estimate(double cells);

  /* Return texts for panels, with numbers of six digits. The first two tell which smoothing length
   * and volume are in use: "0.02 to 0.045 (array h)", "array Mass / array Density". The third tells
   * area and volume or, in two dimensions, length and area; "" if there is no surface. Free them
   * with free(). NULL if memory ran out. */
  char* mcor_describe_smoothing_length(const mcor_input* input, const mcor_statistics* statistics);
  char* mcor_describe_volume(const mcor_input* input);
  char* mcor_describe_measures(const mcor_statistics* statistics);

  /* Warnings: the extraction succeeded, but the input may not be what was meant. */
  typedef enum mcor_warning
  {
    MCOR_WARN_NEIGHBOURS =
      0, /* far too few or too many neighbours (neighbours_median), or too large volumes
          * (filled_median) */
    MCOR_WARN_PLANE,     /* the particles lie in a plane, as in a 2-D simulation */
    MCOR_WARN_ISO_VALUE, /* outside the range of the field */
    MCOR_WARN_TRIMMED,   /* a threshold leaves nothing of the surface */
    MCOR_WARN_PRECISION, /* positions are rounded too much, see position_error */
    MCOR_WARN_TOLERANCE, /* vertices are off the iso value, see vertices_above_tolerance */
    MCOR_WARN_FAR,       /* particles far away are left out, see far_particles */
    MCOR_WARN_PERIOD,    /* the particles extend farther than the period */
    MCOR_WARN_COARSE,    /* the input's positions are rounded by about the particles' distances */
    MCOR_WARNING_COUNT
  } mcor_warning;

  /* Returns the text of the warning, with figures. Returns no message if there is nothing to warn
   * of, if another warning already tells the cause, or with options.globals, because the input then
   * has only some of the particles. Pass the input, options and surface of mcor_extract. After
   * other calls, you may also ask for the last three warnings, which need only `statistics` of the
   * surface. */
  mcor_message mcor_describe_warning(mcor_warning warning, const mcor_input* input,
    const mcor_options* options, const mcor_surface* surface);

  /* Returns a warning if single precision is too coarse for the points of a surface whose largest
   * coordinate, in magnitude, is `largest`; else no message. Both lengths have the same unit. */
  mcor_message mcor_describe_single_points(double largest, double cube_size);
/* If blocks are joined to one set of particles, the array of this name marks the particles of
 * blocks whose names tell of walls. */
#define MCOR_WALL_BLOCK "WallBlock"

  /* The field at given points; free it with mcor_free_samples. */
  typedef struct mcor_samples
  {
    int64_t count;           /* of points */
    double* weight_sum;      /* [count], of fluid particles */
    double* weight_gradient; /* [count][3], unit 1 / L; NULL without MCOR_OUT_GRADIENTS */
    uint8_t* valid; /* [count], 1 where the weight sum is above 1e-30 and not below
                     * options.node_threshold */
    /* For each attribute of the input: the field at the points (MCOR_SUM: the sum; else the Shepard
     * mean) and the gradient of this field. Both are 0 at points that are not valid. */
    double** values;               /* [attribute_count] -> [count][components] */
    double** gradients;            /* [attribute_count] -> [count][components][3], per L; NULL
                                    * without MCOR_OUT_GRADIENTS */
    int64_t* attribute_not_finite; /* [attribute_count], as in mcor_surface */
    int attribute_count;
    mcor_statistics statistics;
  } mcor_samples;

  /* Evaluates the field at points: [count][3], unit L; a point that is not finite is not valid. The
   * scalar of the input is not read. These options apply: sph_kernel, dimension, field, h_scale,
   * outputs, node_threshold, precision, memory_limit, periodic and progress; cube_size and
   * cube_size_factor only set the unit of length on the device. The bits of a point's values do not
   * depend on the other points. *samples is overwritten. */
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

  /* The reading of one line. Lengths: unit L. first, last: distances from the line's beginning. */
  typedef struct mcor_gauge_reading
  {
    mcor_gauge_state state;
    int outside;        /* 1: no particle's support reaches the line */
    double first, last; /* where fluid ends for the first and for the last time; the line's length
                         * if it does not end; NaN where dry */
    double depth;       /* length of the line in fluid; 0 where dry */
    double place[3];    /* of `last`; NaN where dry */
    int64_t first_crossing; /* index of this line's first crossing in mcor_gauges.crossings */
    int64_t crossing_count; /* this line's crossings, into fluid and out of it */
  } mcor_gauge_reading;

  /* What mcor_gauge finds; free it with mcor_free_gauges. */
  typedef struct mcor_gauges
  {
    int64_t count;                /* of lines */
    mcor_gauge_reading* readings; /* [count] */
    int64_t crossing_count;
    double* crossings; /* [crossing_count], ascending for each line, unit L */
    mcor_statistics statistics;
  } mcor_gauges;

  /* Finds where lines cross the free surface. On the free surface, the weight sum equals the level:
   * the iso value, which must be above 0, or 0.5 if there is no iso value. There is fluid where the
   * sum is at least the level. Solids count in the sum, unless they are ignored, and the fluid ends
   * where the solids' share of the sum exceeds wall_share (0.5 unless it is given; 0: solids play
   * no part). Each line is sampled at a quarter of the smallest (scaled) smoothing length, or more
   * finely where neighbouring samples show that an extremum may cross the level; then crossings are
   * solved for. lines: [count]. The options of mcor_probe apply, except field, outputs and
   * node_threshold; iso_values and wall_share apply, too. Ranks must have boxes, globals (of
   * mcor_measure_globals with MCOR_WEIGHT_SUM, level_limit 0 and MCOR_WALL_SHARE_MEASURED, unless a
   * share is given) and the same lines; each rank gets all readings. *gauges is overwritten. */
  mcor_status mcor_gauge(mcor_context* context, const mcor_input* input,
    const mcor_options* options, const mcor_gauge_line* lines, int64_t count, mcor_gauges* gauges);
  void mcor_free_gauges(mcor_gauges* gauges);
  const char* mcor_gauge_state_name(mcor_gauge_state state); /* "dry", "wet", "full" */

  /* Shapes of sections, and the meaning of mcor_section.points. */
  typedef enum mcor_section_shape
  {
    /* a corner, then the other ends of its two edges; the normal is the edges' cross product */
    MCOR_SECTION_RECTANGLE = 0,
    MCOR_SECTION_DISC = 1, /* the centre, and the normal, of any length */
    MCOR_SECTION_BOX =
      2, /* the lowest and the highest corner; the section is the box's sides, normals outwards */
    /* three points per triangle; the normal follows the right-hand rule, but points outwards if the
     * triangles form a closed surface */
    MCOR_SECTION_TRIANGLES = 3,
    /* Two points per line, in two dimensions only. The normal is to the right of the way from the
     * first point to the second. The plane is seen with its first axis (x; y where x is constant)
     * to the right, and its second axis upwards. */
    MCOR_SECTION_LINES = 4,
    MCOR_SECTION_SHAPE_COUNT
  } mcor_section_shape;

  /* Where flow is measured. In two dimensions, a section is a line in the particles' plane, and its
   * area is a length. A rectangle then needs an edge along the constant axis, a disc needs a normal
   * in the plane, and a box has four sides. */
  typedef struct mcor_section
  {
    mcor_section_shape shape;
    const double*
      points; /* [point_count][3], unit L; of a disc the second is a direction; borrowed until return */
    int64_t point_count;
    double radius;    /* of a disc, unit L, above 0 */
    const char* name; /* for messages; may be NULL */
  } mcor_section;

  /* Flow through the part of a section that is in fluid. A is the area of this part, n its normal.
   * v and rho are the Shepard means of velocity and density at the points of this part. */
  typedef struct mcor_flux_reading
  {
    int outside;        /* 1: no particle's support reaches the section */
    double area;        /* A, unit L^2 */
    double volume_flux; /* the integral of v . n */
    double mass_flux;   /* the integral of rho v . n; NaN without densities */
    double velocity;    /* volume_flux / area; NaN where the area is 0 */
  } mcor_flux_reading;

  /* What mcor_flux finds; free it with mcor_free_fluxes. */
  typedef struct mcor_fluxes
  {
    int64_t count;               /* of sections */
    mcor_flux_reading* readings; /* [count] */
    mcor_statistics statistics;
  } mcor_fluxes;

  /* Measures the flow through sections: [count]. The attributes of the input are the velocity (3
   * components; 2 will do in two dimensions) and, if there are two, the density. Fluid is where the
   * weight sum is at least the level, as for mcor_gauge. The tolerances are 2.5e-6 A for `area`,
   * 2.5e-6 A v for volume_flux and 2.5e-6 A v rho for mass_flux, with the section's area A, the
   * greatest speed v and the greatest density rho. Options, globals and ranks are as for
   * mcor_gauge. *fluxes is overwritten. */
  mcor_status mcor_flux(mcor_context* context, const mcor_input* input, const mcor_options* options,
    const mcor_section* sections, int64_t count, mcor_fluxes* fluxes);
  void mcor_free_fluxes(mcor_fluxes* fluxes);

  /* Where an image of column integrals looks, and what it shows. */
  typedef struct mcor_view
  {
    /* Direction of the line of sight; its length and sign do not matter. All 0: the constant
     * axis of a plane, else z. */
    double direction[3];
    /* x0, x1, y0, y1, z0, z1, unit L. The image shows this box, seen along the line of sight. Sides
     * may be infinite. All 0: the box is the period; along axes without a period, it contains all
     * that particles reach. If the line of sight is along x, y or z, a particle counts if its
     * kernel reaches the image and its position along this axis is in the box. For another line of
     * sight, a particle counts if its position is in the box. The whole kernel of a particle
     * that counts is integrated. */
    double box[6];
    int resolution; /* pixels along the longer side, 1 to 32768 */
    /* [count], 1 component. The image shows means, sum V B A F / sum V B F. V: volumes; B: weights;
     * A: the scalar; F: the kernel's column integral, averaged over the pixel. If the weights are
     * the input's masses m, m replaces V B. data NULL: the image shows column integrals. */
    mcor_array weight;
    const uint8_t* counted; /* [count], 0: a particle only helps to compute volumes; NULL: all count */
  } mcor_view;

  /* What mcor_project computes; free it with mcor_free_projection. */
  typedef struct mcor_projection
  {
    int size[2];       /* pixels along the image's axes; 0, 0: there is nothing to see */
    double* values;    /* [size[1]][size[0]], means over pixels: scalar unit x L; NaN where a mean has no weight */
    double axes[9];    /* three unit vectors: along a row, from row to row, and the line of sight */
    double low[3];     /* where the image begins along these axes; along the line of sight, the
                        * nearest place of what counts */
    double pixel[2];   /* sides of a pixel, unit L */
    mcor_statistics statistics;
  } mcor_projection;

  /* Computes column integrals of the scalar's SPH sum, sum V A W, with volumes V, the scalar A and
   * the SPH kernel W. The result is exact to 1e-6 of the largest amount that one particle adds to a
   * pixel. Without a scalar, integrates the density: a pixel then has the mass that falls into it,
   * divided by its area. In two dimensions, the image shows the sum itself. Only fluid counts. The
   * options sph_kernel, dimension, h_scale, periodic and progress apply; if volumes are computed,
   * the options of mcor_derive apply. The result has the same bits for any order of the particles.
   * Each rank gets the whole image. If volumes are computed or h is estimated, ranks need boxes,
   * globals (of mcor_measure_probe_globals), and `counted`, so that each particle counts once.
   * *projection is overwritten. */
  mcor_status mcor_project(mcor_context* context, const mcor_input* input,
    const mcor_options* options, const mcor_view* view, mcor_projection* projection);
  /* Finds the size and place of the image, but not its values. */
  mcor_status mcor_place_view(mcor_context* context, const mcor_input* input,
    const mcor_options* options, const mcor_view* view, mcor_projection* projection);
  void mcor_free_projection(mcor_projection* projection);

  /* Widened smoothing lengths; free them with mcor_free_widening. */
  typedef struct mcor_widening
  {
    int64_t count;  /* of particles */
    double* factor; /* [count]; 1 for solids */
    double* volume; /* [count], for the original lengths; NULL: no volumes are computed */
    uint8_t* outside; /* [count], 1 if statistics.widening_outside counts the particle */
    mcor_statistics statistics;
  } mcor_widening;

  /* Makes a smoother surface possible: bumps on flat surfaces vanish, but drops, threads and sheets
   * stay. Finds the factor s of each fluid particle: the greatest in [1, options.widen] with which
   * the weight sum at the particle, sum_k V_k W(x_j - x_k, s h_j), stays above the iso value of the
   * free surface (above 0.5 if a scalar is contoured); mcor_widen.c has the whole rule. The surface
   * of an input with these factors and volumes has the cubes of the original lengths; with uniform
   * cubes, it has the same bits as the surface for smoothing lengths that are multiplied by the
   * factors, in cubes of the same size. Reads the options of mcor_extract; reads a box only with
   * globals, of mcor_measure_globals with level_limit 0. Results are then valid for particles in
   * the box; the input must have all particles up to 1 + widen support radii away from the box, or
   * (1 + widen) (1 + 1 / h_scale) if volumes are computed. *widening is overwritten. */
  mcor_status mcor_widen(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_widening* widening);
  void mcor_free_widening(mcor_widening* widening);
  /* Adds the seconds and build_seconds of a mcor_widen call to the statistics of a surface, and
   * copies widening_outside to these statistics. */
  void mcor_add_widening(mcor_statistics* surface, const mcor_statistics* widening);

  typedef enum mcor_gradient
  {
    MCOR_GRADIENT_CORRECTED = 0, /* first-order corrected where its matrix can be inverted, else
                                  * standard; exact for linear attributes up to rounding */
    MCOR_GRADIENT_STANDARD = 1   /* sum_j V_j (A_j - A_i) grad W_ij, W_ij with h_j */
  } mcor_gradient;

  /* SPH gradients at the particles; free them with mcor_free_derivatives. */
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

  /* Computes gradients of the attributes of the input at the particles, from sums over fluid
   * particles. The options of mcor_probe apply, except outputs and node_threshold; field only
   * decides whether solids count in computed volumes. A gradient too large for a double is
   * infinite. *derivatives is overwritten. */
  mcor_status mcor_derive(mcor_context* context, const mcor_input* input,
    const mcor_options* options, mcor_gradient form, mcor_derivatives* derivatives);
  void mcor_free_derivatives(mcor_derivatives* derivatives);

  /* Arrays of the caller for quantities of velocity gradients J = S + O (S symmetric, O
   * antisymmetric), in the unit of J or of J^2; NULL: not computed. */
  typedef struct mcor_flow
  {
    double* divergence;  /* [count], tr J */
    double* vorticity;   /* [count][3], curl */
    double* q_criterion; /* [count], (tr(J)^2 - tr(J J)) / 2 */
    double* lambda2;     /* [count], the middle eigenvalue of S S + O O */
    double* strain_rate; /* [count][3][3], S */
  } mcor_flow;

  /* Computes the arrays of `flow` from gradients [count][3][3], d component / d axis, as in
   * mcor_derivatives. */
  mcor_status mcor_decompose_gradients(
    const double* gradients, int64_t count, const mcor_flow* flow);

  /* Frees what the context keeps between calls: results for reuse, and large buffers. */
  void mcor_release_memory(mcor_context* context);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif

#endif
