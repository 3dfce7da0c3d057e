/* SPDX-License-Identifier: BSD-3-Clause
 * Images of volumes by ray casting. */
#ifndef STRATUS_PUBLIC_RAY_CAST_H
#define STRATUS_PUBLIC_RAY_CAST_H

#include "camera.h"
#include "skipping.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The structure by which a ray skips empty space. */
typedef enum stratus_structure {
  STRATUS_STRUCTURE_AUTO,     /* the structure that renders fastest, found by timing; counts of samples and look-ups follow from it */
  STRATUS_STRUCTURE_NONE,     /* no skipping */
  STRATUS_STRUCTURE_BLOCK,    /* empty blocks, one at a time */
  STRATUS_STRUCTURE_DISTANCE, /* distance map, STRATUS_DISTANCE_FULL */
  STRATUS_STRUCTURE_OCTANT,   /* eight distance maps, STRATUS_DISTANCE_OCTANT */
  STRATUS_STRUCTURE_HYBRID    /* the distances in a hybrid tree */
} stratus_structure;

/* Return a structure's name: "auto", "none", "block", "distance", "octant" or "hybrid"; "unknown" for other numbers. */
STRATUS_API const char* stratus_structure_name(stratus_structure structure);
typedef enum stratus_interpolation { STRATUS_INTERPOLATION_LINEAR, STRATUS_INTERPOLATION_NEAREST } stratus_interpolation;

typedef enum stratus_mode {
  STRATUS_MODE_COMPOSITE, /* light absorbed and emitted along the whole ray */
  /* Effective voxels (opacity > 0) are lit, opaque solids. Structure none walks from voxel to voxel. Block and distance read one distance
   * field, octant reads eight, hybrid and auto use a hybrid tree. All structures give the same image. A voxel is a cube about its value, so
   * that the solid reaches half a voxel beyond a volume of points. Sampling, sample distance, termination and block size are not used. A
   * change of colours only rebuilds nothing. */
  STRATUS_MODE_FIRST_HIT,
  STRATUS_MODE_MAXIMUM, /* the largest value sampled along the ray, in its colour and its opacity (which is not per length) */
  STRATUS_MODE_MINIMUM, /* the smallest value sampled along the ray, in its colour and its opacity (which is not per length) */
  /* Grey: the mean of opacity (not per length) times value, over the part of the ray whose values are within average_range. */
  STRATUS_MODE_AVERAGE,
  STRATUS_MODE_ADDITIVE, /* grey: the integral of opacity times value along the ray, with lengths in unit_distance */
  /* Surfaces where the field has a contour value, in that value's colour and opacity (not per length). Surfaces behind one another are
   * blended. Linear interpolation only. The surfaces are exact: along a ray the field is a cubic in each cell, and all its roots are
   * found. */
  STRATUS_MODE_ISOSURFACE,
  /* The values on the surface `slice`, in their colour and opacity (not per length). Points behind one another are blended. The surface is
   * exact, too. */
  STRATUS_MODE_SLICE,
  /* Numbers in place of colours, by which stratus_ray_caster_render_quantities() finds what it computes: the image's rgba holds the largest
   * value, the integral of the field, the length of the ray on which it has a value, and the number of its cells; depth is where the
   * largest value is. Volumes of one component. */
  STRATUS_MODE_QUANTITIES
} stratus_mode;

/* Modes average and additive use each value as a fraction of the whole volume's range of finite values, and limit the result to 1. They are
 * opaque: additive wherever a ray meets the volume's bounds, average wherever a value counts. */

/* Return a mode's name: "composite", "first-hit", "maximum", "minimum", "average", "additive", "isosurface", "slice" or "quantities";
 * "unknown" for other numbers. */
STRATUS_API const char* stratus_mode_name(stratus_mode mode);

typedef enum stratus_normals {
  STRATUS_NORMALS_FACES, /* normal of the voxel face through which the ray enters */
  /* Normal from the field's gradient by central differences, turned towards the ray's origin. Where the gradient is 0, the face's
   * normal. */
  STRATUS_NORMALS_GRADIENT
} stratus_normals;

#define STRATUS_LIGHTS_MAX 8
#define STRATUS_ANISOTROPY_MOST 0.99
#define STRATUS_LIGHT_MAX 1e15 /* largest number in a light or a shading, so that products and sums of such numbers fit floats */

typedef struct stratus_light {
  /* World coordinates, unless the light follows the camera. Positional lights: the light's position. Other lights: the direction from the
   * scene to the light, of any length > 0. */
  double vector[3];
  double color[3]; /* red, green, blue, each 0..STRATUS_LIGHT_MAX */
  int positional;
  /* Positional lights, at the world distance r: the colour is divided by a[0] + a[1] r + a[2] r^2, each number 0..STRATUS_LIGHT_MAX. {0, 0,
   * 0} (default) means no attenuation, like {1, 0, 0}. */
  double attenuation[3];
  /* Positional lights: half the angle of a cone about `axis`, in degrees, above 0 and below 90. There is no light outside the cone. Inside,
   * the colour is multiplied by the cosine of the angle to the axis, to the power `cone_exponent`. 0 (default), or 90 and more: no cone;
   * `axis` and `cone_exponent` are not read. */
  double cone_angle;
  double axis[3]; /* direction in which the light shines, world coordinates, any length > 0 */
  /* 0..STRATUS_LIGHT_MAX */
  double cone_exponent;
  /* 1: highlights have the colour `specular_color`. 0 (default): they have `color`, and `specular_color` is not read. */
  int separate_specular;
  double specular_color[3]; /* red, green, blue, each 0..STRATUS_LIGHT_MAX */
  /* 1: the light, a direction, moves with the camera. `vector` is in the camera's coordinates: x to the right of the picture, y up, z out
   * of the picture. The probe that measures for the tolerance turns the light with its rays. Not for positional lights. 0 (default): the
   * light stays in the world. */
  int follows_camera;
} stratus_light;

/* How one component reflects light. */
typedef struct stratus_material {
  int shade;                                         /* 0: the component is not lit, and the other fields are not read */
  double ambient, diffuse, specular, specular_power; /* with the ranges of stratus_shading */
} stratus_material;

/* Opaque surfaces of a scene, as triangles. */
typedef struct stratus_surfaces {
  const double* points; /* world coordinates, 9 finite numbers a triangle: x, y, z of each corner */
  size_t triangle_count;
  uint64_t revision; /* the caller raises it when numbers change under the same pointer */
} stratus_surfaces;

/* Phong shading. C is the transfer function's colour. First hits are lit by this formula: the lit colour is c = ambient C + sum over lights
 * of diffuse max(0, N L) l C + specular max(0, R V)^power s, where l is a light's colour and s the colour of its highlights.
 *
 * Samples of volumes (composite) and isosurfaces are lit as VTK's mappers light them: N H replaces R V, where H is half way between L and V
 * (Blinn), and specular counts only if N L > 0. N points against the gradient, which is found by central differences. N is 0 where the
 * gradient is 0.
 *
 * If nothing is lit, the other numbers of a shading are neither read nor checked. This is so in first hits if `on` is 0, in composite and
 * isosurface if `shade` is 0, and in all other modes. */
typedef struct stratus_shading {
  int on;                /* first hits; 0: c = C. Default 1. Composite and isosurface read stratus_ray_light_options.shade instead. */
  double ambient;        /* 0..STRATUS_LIGHT_MAX, default .1 */
  double diffuse;        /* 0..STRATUS_LIGHT_MAX, default .9 */
  double specular;       /* default 0 */
  double specular_power; /* 0..STRATUS_LIGHT_MAX, default 10 */
  int light_count;       /* 0..8, or -1 (default): one white light at the eye (parallel: directed from its plane) */
  stratus_light lights[STRATUS_LIGHTS_MAX];
  /* Composite. 1: only sides that face the light are lit; a side faces against the gradient. 0 (default): N is turned towards the eye. */
  int one_sided;
  /* Composite and isosurface. 1: the matter that the renderer draws absorbs light on its way from each light to a sample. Clip planes, crop
   * regions and masks hide matter from light, too. Maps of the light that passes are built again if data, functions or lights change. For
   * lights that move with the camera they are built again with each camera. Default 0. */
  int shadows;
  /* With `shadows`: the world length from a place towards each light within which matter hides the light; at least 0, finite. Matter that
   * is farther away lets all light pass. Surfaces hide light at any distance, and take no shadows. Light that is scattered again passes all
   * matter. 0 (default): the whole way. */
  double shadow_length;
  /* Composite and isosurface: the share of light that the matter scatters, 0..1; the rest is reflected by the gradient as above. A light of
   * colour l scatters diffuse l p C, where p is the phase function of Henyey and Greenstein (1941) times 4 pi:
   * (1 - g^2) / (1 + g^2 - 2 g cos)^1.5. cos is between the directions of light before and after. So diffuse C is the single-scattering
   * albedo, and an irradiance of E is a colour of E / (4 pi). 1 needs no gradients. Default 0. */
  double scattering;
  double anisotropy; /* g, -.99...99; above 0 light scatters forward. Default 0: to all sides alike. */
  /* Composite and isosurface, with scattering above 0. 1: light is scattered any number of times, and shadows are on. The first scattering
   * is computed as above; all others by a solution of the equation of radiative transfer on a grid of about 64^3 cells at most. Albedos
   * above 1 count as 1. The grid is made again as maps are, and if colours or the phase function change. Default 0: light is scattered
   * once. */
  int multiple;
  /* With `multiple`: radiance that comes from infinity, a mix of sky_horizon and sky_zenith by the cosine to `up`; below the horizon it is
   * sky_horizon. The picture's background does not show it. Red, green and blue, each 0..STRATUS_LIGHT_MAX. Default 0: no sky. */
  double sky_zenith[3], sky_horizon[3];
  double up[3]; /* direction of the zenith in the world, of any length > 0. Default z. */
  /* With `shadows`: opaque triangles that hide lights, too. Both sides count. Rays end at them only by
   * stratus_image.opaque_depth. Of light that is scattered again, they hide what comes from lights, and nothing after that. Borrowed
   * during the render. Default NULL: none. */
  const stratus_surfaces* surfaces;
} stratus_shading;

/* Colour and opacity as a function of two variables. The first is the value. The second is the gradient's magnitude or, in volumes of 2
 * components, the value of the second component. The function is bilinear between its entries; with nearest interpolation of values, the
 * nearest entry counts. Beyond the outer entries the function is constant. */
typedef struct stratus_transfer_2d {
  /* rows * columns entries of red, green, blue (not multiplied by opacity) and opacity, each 0..1. Entry (i, j) is at rgba[4*(j*columns +
   * i)]: i is the index of the value's column. Borrowed during the render. */
  const float* rgba;
  int columns, rows; /* 1..4096 */
  /* Value range of the columns, lower < upper, both finite. Column i is centred at lower + (i + 0.5) / columns * (upper - lower). */
  double value_range[2];
  /* Range of the rows, lower < upper, both finite: the gradient's magnitude in values per mean spacing of the grid, as in
   * stratus_transfer.gradient, or values of the second component. */
  double second_range[2];
  double unit_distance; /* world length to which opacities refer, > 0. Opacity 1 is opaque. */
  uint64_t revision;    /* the caller raises it when entries change under the same pointer */
} stratus_transfer_2d;

/* A surface in world coordinates: all x where, with d = x - center, square[0] dx dx + square[1] dy dy + square[2] dz dz + square[3] dx dy +
 * square[4] dy dz + square[5] dx dz + linear . d + constant = 0. A plane sets only linear, to its normal. A sphere sets square to 1, 1, 1,
 * 0, 0, 0 and constant to -radius^2. All numbers are finite. square and linear must not all be 0. */
typedef struct stratus_slice {
  double center[3], square[6], linear[3], constant;
} stratus_slice;

#define STRATUS_CLIP_PLANES_MAX 6
#define STRATUS_CONTOURS_MAX 16
#define STRATUS_CROP_INSIDE 0x2000u
#define STRATUS_CROP_ALL 0x7ffffffu

/* How rays sample the field, and how far they may be off. */
typedef struct stratus_ray_sampling_options {
  /* Default AUTO: the cheapest rule that keeps the tolerance, as a probe measures. Nearest interpolation is never pre-integrated. */
  stratus_sampling rule;
  stratus_interpolation interpolation; /* default linear */
  /* Rule cells: the largest departure of the field from a straight line within a piece, as a fraction of the values that the functions'
   * points span. At least 0 and finite; 0 (default): by the tolerance. A cell has at most 32 pieces. */
  double cell_error;
  /* Rule cells, of one component that is lit without gradient opacity: how far along a ray what it shows may spread about one place at
   * which light is computed: the sum of opacities times squared distances from that place, in squares of a voxel. At least 0 and finite; 0
   * (default): by the tolerance, or a quarter of the default tolerance where rule and cell error are set. */
  double light_spread;
  /* World length of a sample, at most 4096 voxels; 0 (default): by the tolerance. If a voxel's longest side is more than 64 times its
   * shortest, and the distance is automatic, then each ray has its own distance: a fixed fraction or multiple of the voxel length along
   * that ray. */
  double distance;
  double termination; /* a ray ends when its alpha exceeds this, 0..1; 0 (default): by the tolerance */
  /* The root mean square error of RGBA in 0..1 over the lit pixels that the automatic settings may cause. At least 0, finite. Default .001:
   * 60 dB, a quarter of an 8-bit step. 0: the finest settings. The tolerance governs the settings that are left automatic: rule, distance,
   * cell_error, light_spread and termination. */
  double tolerance;
  /* 1: each ray's samples move along it by 0..1 sample distances, by a number made from the pixel and jitter_seed. This turns wood grain
   * into noise. Rule cells does not jitter, and rule local jitters only in its smooth blocks. Default 0. */
  int jitter;
  uint32_t jitter_seed; /* default 0 */
} stratus_ray_sampling_options;

/* How rays skip what is empty. It changes no bit of an image. */
typedef struct stratus_ray_skipping_options {
  stratus_structure structure; /* default AUTO: the structure that renders fastest, found by timing; see the report */
  int block_size;              /* 2, 4, 8, 16, 32; 0 (default): 4, or larger if the maps would need more than 2^28 bytes */
  int audit;                   /* 1: also draw without a structure, and count the pixels whose bits differ. Default 0. */
} stratus_ray_skipping_options;

/* The colour and opacity of samples before they are lit. */
typedef struct stratus_ray_optics_options {
  /* Volumes of several components.
   *
   * 0 (default): each component is a medium with its own transfer function. Composite: where media mix, their optical depths and their
   * emitted light add up. Slice: the same at each point, over a length of which each opacity is. Maximum, minimum, average and additive
   * draw each component by itself. Their premultiplied colours, times the components' weights, add up to at most 1, and so do the alphas of
   * extremes. Isosurface shows each component's surfaces of the contours, and first hits the nearest hit of any component, by depth, with
   * opacities times the components' weights.
   *
   * 1: the components are one medium with one transfer function. Of 2 components, the first has the colour and the second the opacity. Of 4
   * (up to 16 bits, or floats), the first three are red, green and blue in 0..255, and the fourth has the opacity. The gradient is the last
   * component's. Maximum and minimum keep the last component's value, isosurface cuts it, first hits and slice show it by its opacity,
   * each in the colour of the others at that place. Average and additive add the last one's opacity times the first one's value, as VTK's
   * mappers do; average_range is of the first one. */
  int dependent;
  /* Composite and slice, independent components. 0 (default): optical depths add up, as if media share a place. 1: each component counts by
   * its share of the optical depths, so that depths d give (sum of d^2) / (sum of d), while emitted light adds up. VTK's mappers mix
   * components in this way. */
  int mean_components;
  /* Composite, with a gradient opacity F; at least 0, finite. 0 (default): F multiplies the optical depth, which does not depend on a
   * length; a value of opacity 1 stays opaque. Greater than 0: F multiplies the opacity A of a segment of this world length, which then
   * lets 1 - F A pass. VTK's mappers multiply the opacity of a sample in this way. Samples are never pre-integrated then. */
  double gradient_distance;
  /* Composite. The length, before the volume's matrix, that gradient magnitudes are of: of stratus_transfer.gradient, and of functions of
   * two variables. Parts of a field of several spacings need one length. 0 (default): the mean spacing of the grid. */
  double gradient_length;
  /* Composite. A function of two variables, for volumes of one component, or of two if the second component is the function's second
   * variable. NULL (default): none. It replaces the transfer function, which is not read and may be NULL. Samples follow the midpoint rule:
   * other rules and labels give STRATUS_UNSUPPORTED. An automatic step keeps the tolerance as measured. It has no bound from the function,
   * because the function is sampled at both variables. */
  const stratus_transfer_2d* transfer_2d;
  /* Average: the values that count, ends included, first <= last, infinities allowed. Default: all. */
  double average_range[2];
  int contour_count;                     /* isosurface: 1..16; other modes ignore it. Default 0. */
  double contours[STRATUS_CONTOURS_MAX]; /* finite, in any order */
} stratus_ray_optics_options;

/* How samples and surfaces are lit. */
typedef struct stratus_ray_light_options {
  int shade;               /* composite and isosurface; 1: `shading` lights the samples. Default 0. */
  stratus_shading shading; /* used in first hits, and in composite and isosurface if `shade` is 1 */
  /* Composite, isosurface and first hits, independent components: one material for each component, which replaces `shade` and the material
   * in `shading`. The lights of `shading` are read if a material has shade. NULL (default): all components have the material of `shading`.
   * Borrowed during the render. */
  const stratus_material* materials;
  /* First hits; default faces. Where a clip plane or the crop cuts the hit voxel, the hit has the normal of the plane that cuts. */
  stratus_normals normals;
} stratus_ray_light_options;

/* Which part of the volume shows, by planes. */
typedef struct stratus_ray_clipping_options {
  int crop;              /* 1: only the regions of crop_regions show. Default 0. */
  double crop_bounds[6]; /* xmin xmax ymin ymax zmin zmax along the grid's axes: origin + spacing*index, before direction and matrix */
  /* Regions that show, of the 27 into which the bounds' six planes divide space. Bit x + 3 y + 9 z is region (x, y, z), where each
   * coordinate is 0 (below the lower plane), 1 (between the planes) or 2 (above the upper plane). Default STRATUS_CROP_INSIDE: between all
   * planes. First hits support no other value. */
  uint32_t crop_regions;
  int clip_plane_count;                           /* 0..6 */
  double clip_planes[STRATUS_CLIP_PLANES_MAX][4]; /* world coordinates: points with a x + b y + c z + d >= 0 show */
  /* Gradients of light, gradient opacity and functions of two variables read the field one voxel before and behind a sample along each
   * axis. 1: where a clip plane hides that place, they read clipped_value instead. 0 (default): they read the whole field. Grids of equal
   * spacing and one component only. */
  int clip_gradients;
  double clipped_value; /* finite. Default 0. */
} stratus_ray_clipping_options;

/* Which values show or how they are coloured, by a byte for each value. */
typedef struct stratus_ray_mask_options {
  /* One byte for each value of the volume; NULL (default): no mask. A sample is transparent if the byte of the nearest value is 0. A
   * pre-integrated segment is transparent if the byte at either end is 0. First hits show no voxel whose byte is 0. The caster copies the
   * mask when its pointer, its revision or the volume's data changes. */
  const uint8_t* bytes;
  uint64_t revision; /* the caller raises it when the bytes change under the same pointer. Default 0. */
  /* Composite, one component. 0 (default): no labels. 1..255, with a mask: its bytes are labels and hide nothing. A sample has the label of
   * the nearest value, and the interpolated value. If its label l is in 1..label_count, then transfer[l] gives its colour and opacity.
   * Other labels use transfer[0]. A label whose function has no gradient opacity uses the gradient opacity of transfer[0]. Samples with
   * labels are never pre-integrated. */
  int label_count;
} stratus_ray_mask_options;

typedef struct stratus_ray_cast_options {
  stratus_mode mode; /* default composite */
  stratus_ray_sampling_options sampling;
  stratus_ray_skipping_options skipping;
  stratus_ray_optics_options optics;
  stratus_ray_light_options light;
  stratus_ray_clipping_options clipping;
  stratus_ray_mask_options mask;
  stratus_slice slice; /* the surface of mode slice. Default: no surface, which mode slice refuses. */
} stratus_ray_cast_options;

/* Return options with their defaults. */
STRATUS_API stratus_ray_cast_options stratus_ray_cast_options_default(void);

typedef struct stratus_ray_cast_report {
  /* Rays that met the volume's bounds, among the pixels that the occupied part of the volume covers. */
  uint64_t rays;
  uint64_t samples;          /* values interpolated; isosurface: cells visited; first hits: hits */
  uint64_t skipped;          /* segments that the structure skipped */
  uint64_t lookups;          /* reads of the structure, and by rule local of its rough blocks; first hits: tree nodes visited */
  uint64_t differing_pixels; /* pixels that differ in an audit; without an audit 0 */
  /* Number of blocks. First hits: of bricks of 4^3 voxels; those with an effective voxel are occupied. */
  uint64_t blocks, occupied_blocks;
  /* Number of builds of each since the caster was created; first hits: occupancy_builds counts the sets of voxels made. A camera move
   * raises none of them, with one exception: an automatic structure may change once frames have paid for another map. */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads;
  double range_ms, table_ms, occupancy_ms, structure_ms, upload_ms, cast_ms; /* times in this call; 0: the step was not needed */
  /* time in this call of rays drawn to choose the sampling; 0: none */
  double probe_ms;
  /* Shadows: number of times that maps of light were built since the caster was created; the time in this call; their memory; and the root
   * mean square error of the image that is expected of them, by comparing maps of two spacings. */
  uint64_t light_builds;
  double light_ms;
  size_t light_bytes;
  double light_error;
  size_t structure_bytes;
  int window[4];               /* x0, x1, y0, y1: pixels outside [x0, x1) x [y0, y1) show nothing */
  stratus_structure structure; /* the structure used */
  stratus_sampling sampling;   /* the sampling used */
  double sample_distance;      /* the sample distance used, world length; if follows_voxels, of the rays that take the shortest */
  int follows_voxels;          /* 1: each ray's sample distance follows its way through the voxels; otherwise 0 */
  double cell_error;           /* the cell error used by rules cells and local; otherwise 0 */
  double light_spread;         /* the light spread used by rules cells and local if they are lit; otherwise 0 */
  /* measured on the probe's rays, as the tolerance is defined, also if the tolerance is missed; NaN: not measured */
  double expected_error;
  int tolerance_met;      /* 0: the finest setting is expected to miss the tolerance; otherwise 1 */
  uint64_t probe_builds;  /* number of probes since the caster was created */
  uint64_t probe_samples; /* values interpolated by this call's probe */
  /* One sentence: the reasons for structure, sampling and sample distance, and the tried settings. If a device has only a part of the
   * values, or leaves the image to the host, it says so and why. */
  char why[704];
  int offered_tree; /* 1: the structure is the tree of stratus_ray_caster_offer_tree() */
} stratus_ray_cast_report;

/* Add the counts, builds, times, bytes and window of `part` to `sum`, where `part` reports a part of an image, such as one of several
 * blocks. The choices, the expected error and the reasons of `sum` stay. Does nothing if either is NULL. */
STRATUS_API void stratus_ray_cast_report_add(stratus_ray_cast_report* sum, const stratus_ray_cast_report* part);

typedef struct stratus_ray_caster stratus_ray_caster;

/* Create a caster without a volume. Destroy it before its context. */
STRATUS_API stratus_status stratus_ray_caster_create(stratus_context* context, stratus_ray_caster** caster);
STRATUS_API void stratus_ray_caster_destroy(stratus_ray_caster* caster);

/* Draw an image.
 * - volume: the caster borrows its values and ghost flags until the next call with another volume, _release or _destroy.
 * - transfer: one function, or one for each independent component, or label_count + 1 functions.
 * - camera, image: see camera.h. options, report: may be NULL.
 *
 * The caster keeps the structures that it builds, and rebuilds one only when its inputs change. Ranges depend on the volume's pointers,
 * type, dimensions, stride, centring and revision, and on the block size. Occupancy and the structure depend on the ranges, the transfer
 * function, the mode with its values (average_range, contours), and the interpolation. Tables depend on these, on the sampling rule, on the
 * tolerance and, under the midpoint rule, on the sample distance. A camera rebuilds nothing. A change of the voxels' world length makes a
 * new choice of sampling and may rebuild a table.
 *
 * Returns STRATUS_INVALID_ARGUMENT for values outside their ranges, and STRATUS_UNSUPPORTED for combinations that the options' comments
 * exclude. A failed call leaves the image undefined, and the caster ready for the next call. */
STRATUS_API stratus_status stratus_ray_caster_render(stratus_ray_caster* caster, const stratus_volume* volume,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  stratus_ray_cast_report* report);

/* Find the value ranges of a volume's blocks before its first picture, which then has them. For callers that choose functions by values
 * that a source of bricks sees go by: all values are read once. Values of more than 24 bits are read once more, to find the value from
 * which they count. */
STRATUS_API stratus_status stratus_ray_caster_find_ranges(stratus_ray_caster* caster, const stratus_volume* volume);

#define STRATUS_SEVERAL_MAX 8

struct stratus_mesh;          /* mesh.h */
struct stratus_tetra_caster;  /* tetrahedra.h */
struct stratus_tetra_options; /* tetrahedra.h */

/* An input that is drawn with others: a volume, or a mesh of tetrahedra. */
typedef struct stratus_ray_cast_input {
  stratus_ray_caster* caster; /* keeps the structures of this volume; each input needs its own, all of one context; NULL: a mesh */
  const stratus_volume* volume;
  const stratus_transfer* transfer;        /* as in stratus_ray_caster_render() */
  const stratus_ray_cast_options* options; /* of a volume; NULL: the defaults */
  /* keeps the structures of this mesh; each input needs its own, of the same context; NULL: a volume */
  struct stratus_tetra_caster* tetra;
  const struct stratus_mesh* mesh;                   /* read if `tetra` is set */
  const struct stratus_tetra_options* tetra_options; /* of a mesh; NULL: the defaults */
} stratus_ray_cast_input;

/* Draw 1..STRATUS_SEVERAL_MAX volumes as one medium, or in another mode. They may overlap, and each has its own place, grid, type, function
 * and options. Where volumes overlap, their optical depths and their emitted light add up. The order of the inputs matters only to
 * rounding. A single input gives the image of stratus_ray_caster_render().
 *
 * All inputs have the same mode. In all modes but composite, each input is drawn by itself, as stratus_ray_caster_render() or
 * stratus_tetra_caster_render() draws it, and what its rays keep is joined. In maximum, minimum, average and additive this is the best of
 * the values that show, in its own input's colour and opacity; the mean over the lengths of all; the sum of all. Values are fractions of
 * their own input's range. Components are joined one after the other. In first-hit, isosurface and slice the surfaces of all inputs are
 * composited by depth, at equal depth in the order of the inputs. Rays are cast once more for each further surface that may be seen.
 *
 * Composite mode, whole volumes (no DUPLICATE ghosts); other input gives STRATUS_UNSUPPORTED. Components, labels, functions of two
 * variables, light, gradient opacity, masks, crop regions and clip planes are each volume's own. jitter, jitter_seed and audit are read
 * from inputs[0].
 *
 * Sampling: errors of several volumes add up by their squares. Each volume therefore has the rule and the step that its own probe finds for
 * its tolerance divided by the square root of count, or the rule and step that its options set. Volumes that are sampled share one lattice.
 * The lattice's segments are the shortest of these steps, or a half, a third or a quarter of it. Each volume is sampled once every so many
 * whole segments as fit in its own step. Where a volume is sampled cell by cell, in all of it or in its rough blocks, light is composited
 * from one end of its cells' pieces to the next. A piece whose colour changes much is cut further, as with one volume.
 *
 * Meshes (mode composite, method auto or march) are drawn cell by cell: within a segment of the lattice, light is composited from one face
 * to the next. Components, labels, light, gradient opacity, clip planes and crop regions are each mesh's own. Where a mesh's cells overlap,
 * one counts behind the other.
 *
 * reports: NULL, or one for each input. Structures, choices and the expected error in a report concern its own volume. Rays, samples,
 * skipped segments, look-ups, differing pixels, window and cast_ms concern the whole image. The context's device draws; if an input exceeds
 * the device's largest allocation, the host draws, and the reports say why. Each caster borrows and keeps its inputs as in
 * stratus_ray_caster_render(). A failed call leaves the image undefined. */
STRATUS_API stratus_status stratus_ray_caster_render_several(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports);

/* Draw the blocks of a volume that was cut into `count` >= 1 grids. The grids may have any sizes and spacings, and meet at their borders.
 * The blocks are drawn from front to back, each by its own caster in the part of the image that it covers. The parts are blended as floats,
 * so that the borders stay invisible. A block behind opaque blocks is not drawn.
 *
 * inputs: volumes only, no meshes. The blocks should have the same axes: the order follows from their boxes along the axes of inputs[0], by
 * the planes across these axes that separate the boxes. In composite mode, blocks whose boxes overlap are drawn one behind the other, the
 * nearest middle first, and the reports of two of them say so; stratus_ray_caster_render_several() mixes overlapping volumes. In other
 * modes overlapping blocks are joined as several volumes are.
 *
 * All blocks have the same mode. Maximum, minimum, average and additive are of all blocks together: values are fractions of the range of
 * all blocks, and a value has the colour and opacity of its own block's function. Errors along a ray add up by their squares. Each block
 * therefore has the tolerance of its options divided by the square root of the cube root of count.
 *
 * reports: NULL, or one for each block. The report of a block that cannot be seen has zeros, and says so. Each block is drawn as
 * stratus_ray_caster_render() draws a volume. A failed call names the block, and leaves the image undefined. */
STRATUS_API stratus_status stratus_ray_caster_render_blocks(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports);

/* Add the shadows of volumes and meshes to the opaque surfaces behind their picture, which was drawn last, from the same inputs, camera and
 * opaque_depth, and by which lit matter has shadows. The opacity A of each pixel with an opaque_depth below 1 becomes 1 - (1 - A) T: where
 * the picture is blended over the surface, that shows T of its colour. T is the part of the light that passes through the matter: of
 * several lights the mean by brightness, and by the cosine to the surface's normal, which follows from the depths about the pixel. The
 * matter may be elsewhere in the picture. No other value of the image changes; without shadows or opaque_depth, none does. */
STRATUS_API stratus_status stratus_ray_caster_shade_surfaces(
  const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera, const stratus_image* image);

/* Offer a tree that comes with the data, as bytes from stratus_tree_save(). Structure hybrid, and auto in first hits, use it instead of
 * their own tree if stratus_tree_covers() allows it (first hits: if the voxels are exactly the same). The bytes are copied. NULL withdraws
 * the tree. If stratus_tree_load() refuses the bytes, then its status is returned and the tree is withdrawn, too. */
STRATUS_API stratus_status stratus_ray_caster_offer_tree(stratus_ray_caster* caster, const void* bytes, size_t size);

/* Free everything that the caster built, on host and device. The next render rebuilds it. An offered tree stays. */
STRATUS_API void stratus_ray_caster_release(stratus_ray_caster* caster);

#ifdef __cplusplus
}
#endif

#endif
