/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of volumes by ray casting. */
#ifndef STRATUS_PUBLIC_RAY_CAST_H
#define STRATUS_PUBLIC_RAY_CAST_H

#include "camera.h"
#include "skipping.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The structure by which a ray skips empty space. */
typedef enum stratus_structure {
  STRATUS_STRUCTURE_AUTO,     /* the fastest of the others, by times of frames; counts of samples and look-ups follow from it */
  STRATUS_STRUCTURE_NONE,     /* no skipping */
  STRATUS_STRUCTURE_BLOCK,    /* empty blocks, one at a time */
  STRATUS_STRUCTURE_DISTANCE, /* distance map, STRATUS_DISTANCE_FULL */
  STRATUS_STRUCTURE_OCTANT,   /* eight distance maps, STRATUS_DISTANCE_OCTANT */
  STRATUS_STRUCTURE_HYBRID    /* the distances in a hybrid tree */
} stratus_structure;

STRATUS_API const char* stratus_structure_name(stratus_structure structure);
typedef enum stratus_interpolation { STRATUS_INTERPOLATION_LINEAR, STRATUS_INTERPOLATION_NEAREST } stratus_interpolation;

typedef enum stratus_mode {
  STRATUS_MODE_COMPOSITE, /* light absorbed and emitted along the whole ray */
  /* Effective voxels (opacity > 0) are lit, opaque solids. Structure none walks from voxel to voxel, block and distance read one distance
   * field, octant reads eight, hybrid and auto use a hybrid tree: all give the same picture. */
  STRATUS_MODE_FIRST_HIT,
  STRATUS_MODE_MAXIMUM, /* the largest value sampled along the ray, in its colour and its opacity (which is not per length) */
  STRATUS_MODE_MINIMUM, /* the smallest value, likewise */
  /* Grey: the mean of opacity (not per length) times value, over the part of the ray whose values lie in average_range. */
  STRATUS_MODE_AVERAGE,
  STRATUS_MODE_ADDITIVE, /* grey: the integral of opacity times value along the ray, with lengths in unit_distance */
  /* Surfaces where the field has a contour value, in that value's colour and opacity (not per length), one behind the other. Linear
   * interpolation only. The surfaces are exact: along a ray the field is a cubic in each cell, and all its roots are found. */
  STRATUS_MODE_ISOSURFACE,
  /* The values on the surface `slice`, in their colour and opacity (not per length), one point of it behind the other. Exact, too. */
  STRATUS_MODE_SLICE
} stratus_mode;

/* Average and additive take each value as a fraction of the whole volume's range of finite values, and limit the result to 1. They are
 * opaque: additive wherever a ray meets the volume's bounds, average wherever a value counts. */

/* Returns "composite", "first-hit", "maximum", "minimum", "average", "additive", "isosurface" or "slice". */
STRATUS_API const char* stratus_mode_name(stratus_mode mode);

typedef enum stratus_normals {
  STRATUS_NORMALS_FACES, /* normal of the voxel's face that the ray enters through */
  /* Normal from the field's gradient by central differences, turned towards the ray's origin; where the gradient is 0, the face's
   * normal. */
  STRATUS_NORMALS_GRADIENT
} stratus_normals;

#define STRATUS_LIGHTS_MAX 8
#define STRATUS_LIGHT_MAX 1e15 /* largest number of a light's colour or a shading: products and sums of these are floats */

typedef struct stratus_light {
  /* World. Positional: the light's position. Else the direction from the scene to the light, of any length > 0. */
  double vector[3];
  double color[3]; /* red, green, blue, each 0..STRATUS_LIGHT_MAX */
  int positional;
  /* Positional lights, at the world distance r: the colour is divided by a[0] + a[1] r + a[2] r^2, numbers of 0..STRATUS_LIGHT_MAX. All 0
   * (default): it is not, as by 1, 0, 0. */
  double attenuation[3];
  /* Positional lights; half the angle of a cone about `axis`, in degrees, above 0 and below 90, outside which there is no light: inside,
   * the colour is multiplied by the cosine of the angle to the axis, to the power `cone_exponent`, 0..STRATUS_LIGHT_MAX. 0 (default), or 90
   * and more: no cone, and the next two are not read. */
  double cone_angle;
  double axis[3]; /* world: where the light shines, of any length > 0 */
  double cone_exponent;
  int separate_specular;    /* 1: highlights have the next colour. 0 (default): they have `color`, and the next is not read. */
  double specular_color[3]; /* as `color` */
} stratus_light;

/* What light makes of one component. */
typedef struct stratus_material {
  int shade;                                         /* 0: it is not lit, and the rest is not read */
  double ambient, diffuse, specular, specular_power; /* as in stratus_shading */
} stratus_material;

/* Phong shading. With the transfer function's colour C, c = ambient C + sum over lights of diffuse max(0, N L) l C + specular max(0, R
 * V)^power s, where l is a light's colour and s that of its highlights. Samples of volumes (composite) are lit as VTK's mappers light them:
 * N H replaces R V, where H is half way between L and V (Blinn), and specular counts only where N L > 0. N points against the gradient,
 * found by central differences, and is 0 where the gradient is 0. Where nothing is lit, the other numbers of a shading are neither read nor
 * checked: in first hits if `on` is 0, in composite and isosurface if `shade` is 0, and in all other modes. */
typedef struct stratus_shading {
  int on;                /* first hits; 0: c = C. Default 1. Composite reads stratus_ray_cast_options.shade instead. */
  double ambient;        /* 0..STRATUS_LIGHT_MAX, as are the next three; default .1 */
  double diffuse;        /* default .9 */
  double specular;       /* default 0 */
  double specular_power; /* default 10 */
  int light_count;       /* 0..8, or -1 (default): one white light at the eye (parallel: directed from its plane) */
  stratus_light lights[STRATUS_LIGHTS_MAX];
  /* Composite; 1: only sides that face the light, by the direction against the gradient, are lit. Default 0: N is turned towards the
   * eye. */
  int one_sided;
} stratus_shading;

/* Colour and opacity as a function of two variables: the value, and the gradient's magnitude or, in volumes of 2 components, the value of
 * the second. It is bilinear between its entries; with nearest interpolation of values, the nearest entry counts. Beyond the entries at its
 * border, theirs hold. */
typedef struct stratus_transfer_2d {
  /* rows * columns entries of red, green, blue (not multiplied by opacity) and opacity, each 0..1: entry (i, j) is at rgba[4*(j*columns +
   * i)], where i goes with the value. Borrowed during the render. */
  const float* rgba;
  int columns, rows; /* 1..4096 */
  /* From the outer edge of the first column to that of the last, first < second: column i stands for the value (i + .5)/columns of the way.
   */
  double value_range[2];
  /* Likewise of the rows: the gradient's magnitude in values per mean spacing of the grid, as of stratus_transfer.gradient, or values of
   * the second component. */
  double second_range[2];
  double unit_distance; /* world length to which opacities refer, > 0. Opacity 1 is opaque. */
  uint64_t revision;    /* the caller raises it when entries change under the same pointer */
} stratus_transfer_2d;

/* A surface of the world: all x where (with d = x - center) square[0] dx dx + square[1] dy dy + square[2] dz dz + square[3] dx dy +
 * square[4] dy dz + square[5] dx dz + linear . d + constant = 0. A plane has linear, its normal, alone; a sphere square 1, 1, 1 and
 * constant -radius^2. All finite; square and linear are not all 0. */
typedef struct stratus_slice {
  double center[3], square[6], linear[3], constant;
} stratus_slice;

#define STRATUS_CLIP_PLANES_MAX 6
#define STRATUS_CONTOURS_MAX 16
#define STRATUS_CROP_INSIDE 0x2000u
#define STRATUS_CROP_ALL 0x7ffffffu

typedef struct stratus_ray_cast_options {
  stratus_structure structure; /* default auto: the fastest, by times of frames; the report names it */
  /* Default auto: the cheapest that keeps the tolerance, as a probe measures. Nearest interpolation is never pre-integrated. */
  stratus_sampling sampling;
  stratus_interpolation interpolation; /* default linear */
  /* Sampling by cells: the farthest that the field may depart from a straight line within a piece, as a fraction of the values that the
   * functions' points span. At least 0 and finite; 0 (default): by the tolerance. A cell has at most 32 pieces. */
  double cell_error;
  double sample_distance; /* world length, at most 4096 voxels; 0 (default): by the tolerance */
  double termination;     /* a ray ends when its alpha exceeds this, 0..1; 0 (default): by the tolerance */
  /* The root mean square error of RGBA in 0..1 over the lit pixels that the automatic settings may cause. Default .001: 60 dB, a quarter of
   * an 8-bit step. 0: the finest settings. It governs what is left automatic: sampling, sample_distance, cell_error and termination. */
  double tolerance;
  int block_size;        /* 2, 4, 8, 16, 32; 0 (default): 4, or larger where the maps would take more than 2e9 bytes */
  int crop;              /* 1: only the regions of crop_regions show. Default 0. */
  double crop_bounds[6]; /* xmin xmax ymin ymax zmin zmax along the grid's axes: origin + spacing*index, before direction and matrix */
  /* Regions that show, of the 27 into which the bounds' six planes divide space. Bit x + 3 y + 9 z stands for region (x, y, z), where each
   * coordinate is 0 (below the lower plane), 1 (between the planes) or 2 (above the upper plane). Default STRATUS_CROP_INSIDE: between all
   * planes. First hits support no other value. */

  uint32_t crop_regions;
  int clip_plane_count;                           /* 0..6 */
  double clip_planes[STRATUS_CLIP_PLANES_MAX][4]; /* world: points with a x + b y + c z + d >= 0 show */
  int audit;                                      /* 1: also draw without a structure, and count the pixels whose bits differ. Default 0. */
  stratus_mode mode;                              /* default composite */
  /* First hits; default faces. Where a clip plane or the crop cuts a ray's voxel, the hit has the normal of the plane that cuts. */
  stratus_normals normals;
  stratus_shading shading; /* used in first hits, and in composite and isosurface if `shade` is 1 */
  int shade;               /* composite and isosurface; 1: `shading` lights the samples. Default 0. */
  /* Volumes of several components, which all modes but first hits and isosurface draw, dependent ones composite alone. In modes other than
   * composite each independent component is drawn by itself; then their premultiplied colours, times the components' weights, add up to at
   * most 1, and so do the alphas of extremes. Composite, 0 (default): each component is a medium of its own, with a transfer function of
   * its own; where media mix, their optical depths and their emitted light add up. 1: the components are one medium with one transfer
   * function. Of 2 components, the first has the colour and the second the opacity. Of 4 (STRATUS_UINT8 only), the first three are red,
   * green and blue in 0..255, and the fourth has the opacity. The gradient is the last component's. */
  int dependent;
  /* Composite, independent components: a material for each, which holds in place of `shade` and of the material in `shading`; its lights
   * are read if one of them has shade. NULL (default): all have those of `shading`. Borrowed during the render. */
  const stratus_material* materials;
  /* Composite, independent components. 0 (default): their optical depths add up, as where two media share a place. 1: each counts by its
   * share of them, so that depths d give (sum of d^2) / (sum of d), while their emitted light adds up, as VTK's mappers mix components. */
  int mean_components;
  /* Composite, with a gradient opacity F. 0 (default): F multiplies the optical depth, which no length enters; a value of opacity 1 stays
   * opaque. Greater than 0, finite: F multiplies the opacity A of a way of this world length, as VTK's mappers multiply the
   * opacity of a sample: such a way lets 1 - F A pass. Samples are never pre-integrated then. */
  double gradient_distance;
  /* Composite, one component, or two of which the second is the function's second variable; NULL (default): none. It holds in place of the
   * transfer function, which is not read and may be NULL. Samples follow the midpoint rule: other rules, labels and several volumes give
   * STRATUS_UNSUPPORTED. An automatic step keeps the tolerance as measured: the function is sampled at both variables, so that there is no
   * bound from the function alone. */
  const stratus_transfer_2d* transfer_2d;
  stratus_slice slice; /* mode slice. Default: no surface, which mode slice refuses. */
  /* 1: gradients, of light, gradient opacity and functions of two variables, take clipped_value in place of the field a voxel before or
   * behind a sample along an axis, where a clip plane hides that place. 0 (default): they are the whole field's. Grids of equal spacing
   * only. */
  int clip_gradients;
  double clipped_value; /* finite. Default 0. */
  /* Average: the values that count, ends included, first <= last, infinities allowed. Default: all. */
  double average_range[2];
  int contour_count;                     /* isosurface: 1..16; other modes ignore it. Default 0. */
  double contours[STRATUS_CONTOURS_MAX]; /* finite, in any order */
  /* One byte for each value of the volume, NULL: no mask. A sample is transparent where the byte of the nearest value is 0; a
   * pre-integrated segment is transparent where the byte at either end is 0. First hits with a mask give STRATUS_UNSUPPORTED. The caster
   * copies the mask when its pointer, its revision or the volume's data changes. */
  const uint8_t* mask;
  uint64_t mask_revision; /* the caller raises it when the bytes change under the same pointer. Default 0. */
  /* Composite, one component. 0 (default): no labels. 1..255: the mask's bytes are labels and hide nothing. A sample of label l in
   * 1..label_count has the colour and opacity of transfer[l], with the nearest value's label and the interpolated value; other labels have
   * those of transfer[0]. A label without a gradient opacity of its own has that of transfer[0]. Samples with labels are never
   * pre-integrated. */
  int label_count;
  /* 1: each ray's samples move along it by 0..1 sample distances, by a number made from the pixel and jitter_seed. This turns wood grain
   * into noise; rule cells has none, and rule local has some in its smooth blocks. Default 0. */
  int jitter;
  uint32_t jitter_seed; /* default 0 */
} stratus_ray_cast_options;

STRATUS_API stratus_ray_cast_options stratus_ray_cast_options_default(void);

typedef struct stratus_ray_cast_report {
  /* Rays that met the volume's bounds, among the pixels that the occupied part of the volume covers. */
  uint64_t rays;
  uint64_t samples;          /* values interpolated; isosurface: cells visited */
  uint64_t skipped;          /* segments that the structure skipped */
  uint64_t lookups;          /* number of reads of the structure, and by rule local of its rough blocks */
  uint64_t differing_pixels; /* pixels that differ in an audit; else 0 */
  uint64_t blocks, occupied_blocks;
  /* Number of builds of each since the caster was created. A camera move raises none of them, but that an automatic structure may change
   * once frames have paid for another map. */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads;
  double range_ms, table_ms, occupancy_ms, structure_ms, upload_ms, cast_ms; /* times in this call; 0: the step was not needed */
  double probe_ms;                                                           /* likewise: rays drawn to choose the sampling */
  size_t structure_bytes;
  int window[4];               /* x0, x1, y0, y1: pixels outside [x0, x1) x [y0, y1) show nothing */
  stratus_structure structure; /* the one used */
  stratus_sampling sampling;   /* the one used */
  double sample_distance;      /* the one used, world length */
  double cell_error;           /* the one used, of rules cells and local; else 0 */
  double expected_error;       /* by the probe's rays, in the tolerance's terms, also where it is missed; NaN: not measured */
  int tolerance_met;           /* 0: the finest setting is expected to miss the tolerance; else 1 */
  uint64_t probe_builds;       /* number of probes since the caster was created */
  uint64_t probe_samples;      /* values interpolated by this call's probe */
  /* One sentence: the reasons for structure, sampling and sample distance; where a device has a part of the values, or hands the picture
   * to the host, that and its reason; and what was tried. */
  char why[704];
  int offered_tree; /* 1: the structure is the tree of stratus_ray_caster_offer_tree() */
} stratus_ray_cast_report;

/* Adds counts, builds, times, bytes and the window of a part of a picture, as of one of several blocks. What was chosen, the expected error
 * and the reasons stay those of `sum`. Does nothing where one is NULL. */
STRATUS_API void stratus_ray_cast_report_add(stratus_ray_cast_report* sum, const stratus_ray_cast_report* part);

typedef struct stratus_ray_caster stratus_ray_caster;

STRATUS_API stratus_status stratus_ray_caster_create(stratus_context* context, stratus_ray_caster** caster);
STRATUS_API void stratus_ray_caster_destroy(stratus_ray_caster* caster);

/* Draws a picture. transfer: one function, or as many as a volume has independent components, or label_count + 1. The caster borrows
 * volume->values and the ghost flags until the next call with another volume, _release or _destroy. It keeps the structures that it builds,
 * and rebuilds one only when its inputs change: ranges with the volume's pointers, type, dimensions, stride, centring or revision, or the
 * block size; tables, occupancy and structure with the transfer function or the sampling, and tables also with the sample distance. A
 * change of geometry or camera rebuilds nothing. report may be NULL. A failed call leaves the picture undefined, and the caster ready for
 * the next call. */
STRATUS_API stratus_status stratus_ray_caster_render(stratus_ray_caster* caster, const stratus_volume* volume,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  stratus_ray_cast_report* report);

#define STRATUS_SEVERAL_MAX 8

struct stratus_mesh; /* tetrahedra.h */
struct stratus_tetra_caster;
struct stratus_tetra_options;

/* One of several volumes that are drawn together, or a mesh of tetrahedra among them. */
typedef struct stratus_ray_cast_input {
  stratus_ray_caster* caster; /* keeps what is built of this volume: one of its own for each input, all of one context; NULL: a mesh */
  const stratus_volume* volume;
  const stratus_transfer* transfer;                  /* as in stratus_ray_caster_render() */
  const stratus_ray_cast_options* options;           /* of a volume; NULL: the defaults */
  struct stratus_tetra_caster* tetra;                /* keeps what is built of a mesh, likewise; NULL: a volume */
  const struct stratus_mesh* mesh;                   /* read where `tetra` is set */
  const struct stratus_tetra_options* tetra_options; /* of a mesh; NULL: the defaults */
} stratus_ray_cast_input;

/* Draws 1..STRATUS_SEVERAL_MAX volumes that may overlap, each with a place, grid, type, function and options of its own, as one medium:
 * where volumes overlap, their optical depths and their emitted light add up, whatever the order of the inputs but for rounding. One input
 * alone gives the picture of stratus_ray_caster_render().
 *
 * Composite mode, whole volumes (no DUPLICATE ghosts), and as crop regions the inside or all: other input gives STRATUS_UNSUPPORTED.
 * Components, labels, functions of two variables, light, gradient opacity, masks, crop boxes and clip planes are each volume's own. jitter,
 * jitter_seed and audit are those of inputs[0].
 *
 * Sampling: each volume has the rule and the step that its own probe finds for its tolerance divided by the square root of count, for
 * errors of several volumes add up by their squares; or those that its options set. Volumes that take samples share one lattice, whose
 * segments are the shortest of these steps, or a half, a third or a quarter of it; each takes a sample every so many whole segments as fit
 * in its own step. Where a volume goes cell by cell, in all of it or in its rough blocks, light is composited from one end of its cells'
 * pieces to the next. What is composited at once is cut into pieces where its colour changes much, as with one volume.
 *
 * Meshes, of mode composite and by method auto or march, are drawn cell by cell: within a segment of the lattice, light is composited from
 * one face to the next. Their clip planes and crop boxes are their own, and where their cells overlap one counts behind the other. The host
 * draws them.
 *
 * reports: NULL, or one for each input. Each tells of its own volume what was built, chosen and expected, and of the whole picture the
 * rays, samples, skipped segments, look-ups, differing pixels, window and cast_ms. The context's device draws; where one of the volumes
 * exceeds its largest allocation the host does, and the reports say why. Each caster borrows and keeps what it does in
 * stratus_ray_caster_render(). A failed call leaves the picture undefined. */
STRATUS_API stratus_status stratus_ray_caster_render_several(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports);

/* Draws the blocks of a volume that was cut into `count` >= 1 grids, of any sizes and spacings, that meet at their borders: from front to
 * back, each by its own caster in the part of the picture that it covers. The parts are blended as floats, so that the borders show
 * nothing. A block behind what is opaque already is not drawn. inputs: volumes alone, no meshes. The blocks' axes should be the same: the
 * order follows from their boxes along the axes of inputs[0], by the planes across these axes that part them. Blocks whose boxes overlap
 * are drawn one behind the other, the nearest middle first, and the reports of two of them say so; stratus_ray_caster_render_several()
 * mixes them.
 *
 * Modes composite, first-hit, isosurface and slice; others give STRATUS_UNSUPPORTED for more than one block. Errors along a ray add up by
 * their squares, so that each block has the tolerance that its options tell, divided by the square root of the cube root of count.
 * reports: NULL, or one for each block; a block that can't be seen has zeros, and says so. What else holds of
 * stratus_ray_caster_render() holds of each block. A failed call names the block, and leaves the picture undefined. */
STRATUS_API stratus_status stratus_ray_caster_render_blocks(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports);

/* First hits (STRATUS_MODE_FIRST_HIT): a voxel is a cube about its value, so that the solid reaches half a voxel beyond a volume of points.
 * In the report, samples are hits, lookups are nodes that trees visited, blocks and occupied_blocks are bricks of 4^3 voxels that hold an
 * effective one, and occupancy_builds counts the sets of voxels made. Sampling, sample distance, termination and block size are not used. A
 * change of colours alone rebuilds nothing. */

/* Offers a tree that comes with the data, as bytes from stratus_tree_save(). Structure hybrid, and auto in first hits, use it instead of a
 * tree of their own where stratus_tree_covers() allows it (first hits: where the voxels are exactly the same). The bytes are copied. NULL
 * withdraws the tree. Bytes that stratus_tree_load() refuses give its status, and withdraw the tree too. */
STRATUS_API stratus_status stratus_ray_caster_offer_tree(stratus_ray_caster* caster, const void* bytes, size_t size);

/* Frees all that was built, on host and device; the next render rebuilds it. An offered tree stays. */
STRATUS_API void stratus_ray_caster_release(stratus_ray_caster* caster);

#ifdef __cplusplus
}
#endif

#endif
