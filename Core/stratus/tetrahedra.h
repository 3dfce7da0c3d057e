/* SPDX-License-Identifier: BSD-3-Clause
 * Images of meshes of tetrahedra. */
#ifndef STRATUS_PUBLIC_TETRAHEDRA_H
#define STRATUS_PUBLIC_TETRAHEDRA_H

#include "ray_cast.h"
#include "visibility.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A caster draws every cell that a ray meets with its exact thickness. Values of points are linear between the ray's entry and exit; a
 * cell's own value is constant. The transfer function is pre-integrated over the cell. Faces are intersected exactly, in one plane for all
 * cells, so that no ray slips between two cells or meets a face twice. Marching needs no order of cells: a ray moves from cell to cell
 * through faces, and meets the borders of gaps, hollows and separate parts in their order along it. Folded and inverted cells are drawn as
 * separate parts: where cells overlap, both count, one after the other. */

typedef enum stratus_tetra_mode {
  STRATUS_TETRA_COMPOSITE, /* light absorbed and emitted along the whole ray */
  STRATUS_TETRA_MAXIMUM,   /* the largest value on a ray, in its colour and the opacity of one unit distance */
  STRATUS_TETRA_MINIMUM,   /* the smallest value on a ray, in its colour and the opacity of one unit distance */
  /* Grey: the mean of opacity (not per length) times value, over the part of the ray whose values are within average_range. */
  STRATUS_TETRA_AVERAGE,
  STRATUS_TETRA_ADDITIVE, /* grey: the integral of opacity times value along the ray, with lengths in unit_distance */
  /* Surfaces where the field has a contour value, in that value's colour and opacity (not per length), at their exact places. Surfaces
   * behind one another are blended. Values of points only. */
  STRATUS_TETRA_ISOSURFACE,
  /* The values on the surface `slice`, in their colour and opacity (not per length). Points behind one another are blended. The surface is
   * exact, too. */
  STRATUS_TETRA_SLICE,
  /* The first place along a ray where the field's opacity is above 0, as a lit, opaque solid. Values of cells: the first such cell. Values
   * of points: the place within a cell where its linear field begins to show. */
  STRATUS_TETRA_FIRST_HIT,
  STRATUS_TETRA_QUANTITIES /* as STRATUS_MODE_QUANTITIES; only stratus_ray_caster_render_several() takes it */
} stratus_tetra_mode;

/* Modes average and additive use each value as a fraction of the range of the values that show, and limit the result to 1. They are opaque:
 * additive wherever a ray meets a cell, average wherever a value counts. */

/* Return a mode's name: "composite", "maximum", "minimum", "average", "additive", "isosurface", "slice", "first-hit" or "quantities";
 * "unknown" for other numbers. */
STRATUS_API const char* stratus_tetra_mode_name(stratus_tetra_mode mode);

#define STRATUS_TETRA_CLIP_PLANES_MAX 6
#define STRATUS_TETRA_CONTOURS_MAX 16
#define STRATUS_TETRA_LABELS_MAX 255

/* Both methods draw the same image: they find the same faces at the same depths, and shade pieces of cells by the same sums. They differ by
 * the rounding of floats: below .01 of 255 in the mean (root mean square), at any distance, and however much a parallel camera's right and
 * up lean towards its forward. (A perspective camera's right and up are used as given: if they are more than 60 degrees off the right
 * angle, thickness loses digits.) If a pixel's cells come out of order, projection redraws the pixel, nearest piece first, so that the
 * image does not depend on the order of cells. The methods differ only where cells overlap: projection draws the pieces in order of depth,
 * marching one path through neighbours after the other. */
typedef enum stratus_tetra_method {
  /* The method that should cost less. It is chosen by the numbers of cells, pixels and segments, and by their costs on this machine; on a
   * GPU it is march. It does not change while the camera stands still. */
  STRATUS_TETRA_METHOD_AUTO,
  STRATUS_TETRA_METHOD_MARCH, /* follows each ray from cell to cell */
  /* Sorts the cells that can show, assigns them to tiles of pixels, and composites them there. It draws composite and maximum, one
   * component, without light, gradient opacity or labels. Other requests give STRATUS_UNSUPPORTED, while auto marches. */
  STRATUS_TETRA_METHOD_PROJECT
} stratus_tetra_method;

/* Return a method's name: "auto", "march" or "project"; "unknown" for other numbers. */
STRATUS_API const char* stratus_tetra_method_name(stratus_tetra_method method);

typedef struct stratus_tetra_options {
  stratus_tetra_mode mode; /* default composite */
  /* Composite: a ray ends when its alpha exceeds this, 0..1; 0 (default): by the tolerance, which gives .9999 for the default tolerance. */
  double termination;
  /* Composite: the root mean square error of RGBA in 0..1, over the lit pixels, that the division of cells into pieces and an automatic
   * termination may cause. At least 0, finite. A piece's colours are averaged, and so a cell in which light falls and colour changes is
   * divided. Default .001: 60 dB, a quarter of an 8-bit step. 0: the finest division. The error excludes the rounding of values to the
   * entries of a table. */
  double tolerance;
  stratus_tetra_method method; /* default auto */
  /* Leaves of the mesh, for the order that projection needs: leaves are sorted in parallel. Borrowed until the caster draws with other
   * leaves or is released. Default NULL: one leaf. */
  const stratus_leaves* leaves;
  /* Rays are cut exactly where they pass a plane: cells are cut, not left out. */
  int clip_plane_count;                                 /* 0..6 */
  double clip_planes[STRATUS_TETRA_CLIP_PLANES_MAX][4]; /* world coordinates: points with a x + b y + c z + d >= 0 show */
  int crop;                                             /* 1: only the regions of crop_regions show. Default 0. */
  double crop_bounds[6];                                /* xmin xmax ymin ymax zmin zmax, local coordinates; infinities allowed */
  /* Regions that show, as in stratus_ray_clipping_options. Default STRATUS_CROP_INSIDE: between all planes. Others, by marching. */
  uint32_t crop_regions;
  /* Average: the values that count, ends included, first <= last, infinities allowed. Default: all. */
  double average_range[2];
  int contour_count;                           /* isosurface: 1..16; other modes ignore it. Default 0. */
  double contours[STRATUS_TETRA_CONTOURS_MAX]; /* finite, in any order */
  stratus_slice slice;                         /* the surface of mode slice. Default: no surface, which mode slice refuses. */
  /* Composite, isosurface and first hits, by marching. 1: `shading` lights the samples or solids. Default 0. The gradient of a cell is
   * constant. A point's gradient is the mean over its cells, weighted by their volumes. Between points the gradient is interpolated as
   * values are, so that light is smooth across cells. Values of cells are first averaged at points, in the same way. */
  int shade;
  stratus_shading shading; /* `on` is not read */
  /* First hits, if `shade` is 1; default faces: the normal of the cell's face by which the ray enters, or of the surface on which the field
   * of values of points begins to show, which is flat in each cell. Gradient: the interpolated gradient, or that normal where the gradient
   * is 0. Where a clip plane or the crop cuts the hit cell, the hit has the normal of the plane that cuts. */
  stratus_normals normals;
  /* Composite, with a gradient opacity F, by marching. 0 (default): F multiplies the optical depth; a value of opacity 1 stays opaque if F
   * is above 0. Greater than 0: F multiplies the opacity of a segment of this world length. Less than 0: F multiplies the opacity of a
   * segment of half a spacing in the world. Finite. A spacing is the edge of a cube that six cells of the mean volume fill. The gradient's
   * magnitude is in values per spacing, whatever the mesh's matrix. */
  double gradient_distance;
  /* Values of several components, by marching. A value that is not finite in any component hides its cells.
   *
   * 0 (default): each component is a medium with its own transfer function. Composite: optical depths, times the functions' weights, and
   * emitted light add up. Slice: the same at each point, over a length of which each opacity is. Isosurface: the surfaces of all, whose
   * opacities are times the functions' weights, are blended in their order along the ray. First hits: the nearest hit of the components
   * whose weight is above 0. Maximum, minimum, average and additive draw each component by itself. Their premultiplied colours, times the
   * functions' weights, add up to at most 1, and so do the alphas of extremes.
   *
   * 1: the components are one medium with one function. Of 2 components, the first has the colour and the second the opacity. Of 4
   * (up to 16 bits, or floats), the first three are red, green and blue in 0..255, and the fourth has the opacity. Maximum and minimum keep
   * the last component's value, isosurface cuts it, first hits and slice show it by its opacity, each in the colour of the others at that
   * place. Average and additive add the last one's opacity times the first one's value; average_range is of the first one. */
  int dependent;
  /* Composite, isosurface and first hits, independent components: one material for each component, which replaces `shade` and the material
   * in `shading`. The lights of `shading` are read if a material has shade. NULL (default): all components have the material of `shading`.
   * Each component is lit, and its opacity multiplied, by its own gradient; dependent components by the last one's gradient. Borrowed
   * during the render. */
  const stratus_material* materials;
  /* Independent components, composite and slice. 1: each counts by its share of the optical depth, as in stratus_ray_cast_options. Default
   * 0. */
  int mean_components;
  /* Composite, one component, by marching. 0 (default): no labels. 1..255: cells have the mesh's labels, which hide nothing. If a cell's
   * label l is in 1..label_count, then transfer[l] gives the colour and opacity of its values. Other labels use transfer[0]. A label whose
   * function has no gradient opacity uses the gradient opacity of transfer[0]. */
  int label_count;
} stratus_tetra_options;

/* Return options with their defaults. */
STRATUS_API stratus_tetra_options stratus_tetra_options_default(void);

typedef struct stratus_tetra_report {
  stratus_tetra_method method; /* march or project */
  char why[256];               /* one sentence: the reason for the method */
  /* March: pixels whose ray meets a cell, in front of the eye or behind it. Project: pixels whose ray meets a cell that can show. */
  uint64_t rays;
  uint64_t entries; /* march: faces through which rays entered the mesh */
  /* March: cells that rays passed, including those before the near plane. Project: pieces of cells that were composited. */
  uint64_t segments;
  /* Paths through cells that ended inside the mesh because no exit face was found: 0 unless coordinates underflow. */
  uint64_t stuck;
  int64_t cells, shown_cells; /* cells of the mesh, six for each hexahedron of a lattice; cells neither hidden nor blanked */
  /* Cells that are not hidden but left out: their values are not finite floats, or they name a point more than once. */
  int64_t blanked;
  int64_t repeated;     /* the blanked cells that name a point more than once, and so have no volume */
  int64_t border_faces; /* border faces of shown cells */
  /* Cells without volume; cells of negative orientation; faces that more than two cells share; faces that two cells on the same side
   * share. */
  int64_t flat, inverted, broken_faces, folded_faces;
  /* Builds since the caster was created: a camera move adds none. Other values on the same points and cells add only to value_builds if the
   * same cells show. */
  uint64_t mesh_builds, value_builds, table_builds;
  /* builds of gradients since the caster was created: one for values that are lit or have a gradient opacity */
  uint64_t gradient_builds;
  double build_ms, table_ms, transform_ms, entries_ms, march_ms; /* times in this call; 0: the step was not needed */
  int64_t cells_in_view;                                         /* project: cells that can show in some pixel */
  uint64_t pairs;                                                /* project: pairs of a cell and a tile */
  int32_t leaves;                                                /* project: number of leaves sorted in parallel */
  int64_t cycles;                                                /* project: cycles of the order, see stratus_visibility_result */
  uint64_t again;                                                /* project: pixels drawn again because their cells came in a wrong order */
  double sort_ms, bin_ms, project_ms; /* project: times of the order, of the cells' outlines and tiles, and of the pixels */
  size_t bytes;                       /* bytes kept for the mesh, and for a frame */
  /* Shadows: as in stratus_ray_cast_report. */
  uint64_t light_builds;
  double light_ms;
  size_t light_bytes;
  double light_error;
} stratus_tetra_report;

typedef struct stratus_tetra_caster stratus_tetra_caster;

/* Limits on lengths. Beyond a limit a render returns STRATUS_INVALID_ARGUMENT, with the number in the message.
 * - STRATUS_TETRA_REACH bounds world lengths between the camera and the mesh from above. Its inverse bounds the mesh's length from below (a
 *   single point is allowed). So lengths, and optical depths divided by them, are floats with all their digits. It also bounds coordinates
 *   in units of a perspective camera's right and up, times the length of forward, and how far a parallel camera's right and up lean along
 *   forward.
 * - STRATUS_TETRA_WINDOWS bounds the distance of the mesh from the middle of a parallel camera's window, in units of half the window's
 *   width, so that products of two such coordinates and a value are floats. It also bounds the ratio of a perspective camera's right and up
 *   to the length of forward. */
#define STRATUS_TETRA_REACH 1237940039285380274899124224.0 /* 2^90, about 1.2e27 */
#define STRATUS_TETRA_WINDOWS 1099511627776.0              /* 2^40, about 1.1e12 */

/* Create a caster without a mesh. Destroy it before its context. */
STRATUS_API stratus_status stratus_tetra_caster_create(stratus_context* context, stratus_tetra_caster** caster);
STRATUS_API void stratus_tetra_caster_destroy(stratus_tetra_caster* caster);

/* Draw an image.
 * - mesh: must have values. The caster reads it again if its pointers, counts, type, stride or revision differ from the last call's,
 *   otherwise only its matrix.
 * - transfer: one function, or one for each independent component, or label_count + 1 functions. Opacity is per world length.
 * - image: samples receives the number of segments in the pixel; depth receives the world distance to the first segment that contributes
 *   (maximum: to the largest value).
 * - options, report: may be NULL.
 *
 * Both methods use the context's device, or the host if there is no device or the mesh is too large for it. Projection finds the cells of
 * each tile on the host. Lattices are marched by their points' numbers, which keeps about 21 bytes for each point and 56 for each face at
 * the border. A lattice whose cells have both orientations (tripolar grids, folded layers) needs one more byte per point. Projection lists
 * a lattice's tetrahedra; marching does not.
 *
 * A failed call leaves the image undefined, and the caster ready for the next call. More than INT32_MAX/8 cells, INT32_MAX/4 points or
 * INT32_MAX/8 faces at the border give STRATUS_UNSUPPORTED. */
STRATUS_API stratus_status stratus_tetra_caster_render(stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image,
  stratus_tetra_report* report);
/* Free everything that the caster built. The next render rebuilds it. */
STRATUS_API void stratus_tetra_caster_release(stratus_tetra_caster* caster);

#ifdef __cplusplus
}
#endif

#endif
