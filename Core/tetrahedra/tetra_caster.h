/* SPDX-License-Identifier: BSD-3-Clause
 * The renderer of tetrahedra: its state, and the steps of a render that have files of their own. */
#ifndef STRATUS_TETRA_CASTER_H
#define STRATUS_TETRA_CASTER_H

#include "volume.h"
#include "light_maps.h"
#include "tetra_march_frame.h"
#include "tetra_device.h"
#include "tetra_project.h"

typedef enum stratus_tetra_show {
  STRATUS_TETRA_HIDDEN,
  STRATUS_TETRA_SHOWN,
  STRATUS_TETRA_FLAT /* shown, but without a volume: its values do not count for the range */
} stratus_tetra_show;

/* A mesh as rays read it, made once for all views. Only shown cells are linked to each other. */
struct stratus_tetra_mesh {
  stratus_context* context;
  /* Of lattices the number of each one's first point, and last the end; NULL: cells are listed. Between two lattices there may be numbers
   * of no point. */
  int64_t* first;
  int lattices;
  /* TETRA_CELL ints per cell, in the order of stratus_tetra_places; of a lattice a bit per point: its hexahedron shows */
  int32_t* cells;
  /* Of lattices whose tetrahedra turn both ways a byte per point, which says of the hexahedron what its bit in `cells` says, and which of
   * its tetrahedra turn left (tetra_arguments.h); rays read it in place of `cells`. NULL: there is no such lattice. */
  uint8_t* turns;
  size_t cell_ints, value_count; /* ints that rays read of cells; values */
  /* Number of each mesh point in `cells` and `faces`: points are numbered as cells first use them. NULL: a lattice's points keep theirs. */
  int32_t* names;
  float* values;      /* a fetched value per mesh point; NULL: values belong to cells */
  float* cell_values; /* a fetched value per cell, in the order of `cells`, of a lattice at first corners; NULL: values belong to points */
  uint8_t* shown;     /* stratus_tetra_show per mesh cell; NULL: a lattice */
  uint32_t* at;       /* the mesh cell at each place of `cells`; NULL: values belong to points */
  int8_t* nominal;    /* per mesh cell, during the build only: its orientation, of flat cells their neighbours' orientation; 0: none */
  stratus_tetra_face* faces;
  size_t face_count;
  double lo[3], hi[3]; /* bounds of the points that shown cells use, in local coordinates */
  float low, high;     /* range of the fetched values of shown cells; low > high: there is none */
  double bias;
  int64_t cell_count, point_count; /* of lattices also the numbers of no point */
  int64_t shown_cells, blanked, repeated, flat, inverted, broken, folded;
  uint64_t geometry, identity; /* hash of points and vertices; stratus_tetra_identity() */
  size_t bytes;
};

/* Gradients at points. They are made when light or gradient opacity first needs them, and dropped with the values. */
typedef struct stratus_tetra_gradients {
  /* in local coordinates, four floats a point in the order of `names`, the fourth 0, set after set; NULL: none */
  float* vectors;
  unsigned mask;                         /* bit c: component c has a set */
  int sets, set[STRATUS_COMPONENTS_MAX]; /* of a component, -1: none */
  double unit[STRATUS_COMPONENTS_MAX];   /* factor of a component's gradients */
  double spacing;                        /* the edge of a cube that six cells of the mean volume fill */
  size_t bytes;
} stratus_tetra_gradients;

/* Values of several components as rays read them. */
typedef struct stratus_tetra_components {
  int count;     /* 0: there is nothing here */
  float* places; /* of each value, in the order of stratus_tetra_mesh's values by name: four floats, places in tables */
  int32_t* sums; /* of all tables, each as stratus_tetra_sums() */
  /* Of labels: `places` has the label of each cell, in the order of `cells`, of a lattice at first corners; before `sums` are the labels'
   * records (tetra_arguments.h); and this is what their tables have in common. */
  stratus_table_arguments table;
  size_t place_count, sum_count;
  int sums_at[4];
  float last[4], depth_scale[4], scale[4], offset[4]; /* the last two: from fetched values to places */
  float least[4];                                     /* the least fetched value, which all have where the scale is 0 */
  double bias[4];
  float low, high; /* range of the first one's fetched values of shown cells */
  bool has_opaque[4], shown;
  /* Independent components of isosurfaces have fetched values for places, and no tables, and of first hits stratus_tetra_shown_sums() */
  stratus_tetra_mode mode;
  bool dependent;              /* inputs from which the tables were made, as are the next fields */
  stratus_transfer* transfers; /* copies */
  int transfer_count;
  uint64_t values; /* the caster's value_builds */
} stratus_tetra_components;

/* Entries of a table. Segments end at any value, which is rounded to an entry: the error of light falls with the width of entries. */
#define STRATUS_TETRA_ENTRIES 32768

/* How values are drawn: the tables of a transfer function. */
typedef struct stratus_tetra_look {
  stratus_transfer* transfer; /* a copy */
  stratus_tetra_mode mode;    /* mode of the tables, as is the next field */
  double average_range[2];
  stratus_table* table; /* NULL: none yet */
  int32_t* sums;        /* stratus_tetra_sums(), or stratus_tetra_value_sums() */
} stratus_tetra_look;

#define STRATUS_TETRA_PARTS 3 /* components beyond the first */

/* Data of a component other than the first, if each is drawn by itself. Its fields replace the fields of the same name of a
 * stratus_tetra_mesh and a caster. */
typedef struct stratus_tetra_part {
  float* values; /* NULL: none yet */
  float low, high;
  double bias;
  stratus_tetra_look look;
} stratus_tetra_part;

typedef struct stratus_tetra_costs stratus_tetra_costs; /* tetra_costs.h */
typedef struct stratus_tetra_list stratus_tetra_list;   /* tetra_lattice.h */

struct stratus_tetra_caster {
  stratus_context* context;
  int layers;               /* > 0: pictures hold so many layers, as stratus_light_draw has them */
  int keeps;                /* > 0: pictures hold what rays keep, of surfaces this one of each ray, the nearest is 1 */
  stratus_mesh view;        /* the source of `mesh`; the list's where a lattice is listed */
  stratus_tetra_list* list; /* NULL: none */
  stratus_tetra_mesh* mesh;
  stratus_tetra_projector* projector; /* NULL until something is projected */
  stratus_tetra_look look;            /* of the first component */
  stratus_tetra_part parts[STRATUS_TETRA_PARTS];
  uint64_t part_values;         /* `value_builds` that the parts were made from */
  stratus_tetra_device* device; /* buffers on the OpenCL device; NULL: none */
  stratus_tetra_buffers buffers;
  stratus_tetra_gradients gradients;
  float* factors;                     /* the gradient opacities of components or labels, STRATUS_SHADING_FACTORS + 2 each; NULL: none */
  stratus_transfer* factor_transfers; /* copies of the functions from which they were made */
  int factor_count;                   /* number of these copies */
  float factor_scale[STRATUS_COMPONENTS_MAX]; /* not of labels, whose records have it */
  stratus_tetra_components components;
  uint64_t mesh_builds, value_builds, table_builds, gradient_builds, component_builds;
  const stratus_light_maps* lights;  /* shadows: the picture's maps; NULL: none */
  stratus_light_state light;         /* of a picture of this one mesh, or of several inputs of which it is the first */
  struct stratus_tetra_caster* dark; /* draws the matter that absorbs light; NULL: none */
  bool on_host;                      /* it never draws on the device */
  const stratus_tetra_costs* costs;  /* costs used instead of measured ones, for tests; NULL: none */
};

/* The input of a render. */
typedef struct stratus_tetra_subject {
  const stratus_mesh* mesh;
  const stratus_transfer* transfer;
  const stratus_tetra_options* options;
} stratus_tetra_subject;

/* tetra_caster.c: draws what rays keep in one component by marching (kernels/tetrahedra/tetra_arguments.h, `kept`). Values in the image are
 * relative to *bias. keeps: as in the caster. */
stratus_status stratus_tetra_caster_render_kept(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  int component, int keeps, const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, double* bias,
  stratus_tetra_report* report);
/* tetra_caster.c: makes a frame of mode composite whose rays another room marches: its entries are still to be counted, and to be found by
 * tile. *shows false: nothing of the mesh shows, and there is no frame. */
stratus_status stratus_tetra_caster_prepare(stratus_tetra_caster* caster, const stratus_tetra_subject* of, const stratus_camera* camera,
  const stratus_image* image, stratus_tetra_frame* frame, bool* shows, stratus_tetra_report* report);
/* tetra_caster.c: stratus_tetra_device_enter() for such a frame. */
stratus_status stratus_tetra_caster_enter(stratus_tetra_caster* caster, stratus_tetra_frame* frame, const char** why_not);

/* tetra_mesh.c. The mesh passed stratus_mesh_check() and has values. The hash covers the data from which neighbours, planes and orders
 * follow. */
uint64_t stratus_tetra_hash(const stratus_context* context, const stratus_mesh* mesh);
/* The caller's numbers of these data, of all blocks. 0: not known. */
uint64_t stratus_tetra_identity(const stratus_mesh* mesh);
stratus_status stratus_tetra_mesh_create(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_mesh** out);
void stratus_tetra_mesh_destroy(stratus_tetra_mesh* mesh); /* takes NULL */
/* Gives the local bounds of all finite coordinates of a mesh, or of its blocks. Returns false if an axis has none. */
bool stratus_tetra_box(const stratus_mesh* mesh, double lo[3], double hi[3]);
/* Whether the mesh has the content in points and vertices, not merely the pointers, that `tetra` was made from. */
bool stratus_tetra_mesh_fits(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh);
/* Takes other values of a mesh that fits. *taken false: other cells show by them, so that the borders differ; then nothing has changed. */
stratus_status stratus_tetra_mesh_take_values(stratus_tetra_mesh* tetra, const stratus_mesh* mesh, bool* taken);
/* Whether a cell is drawn: it is not hidden, names four different points, and its values are finite. range: their least and greatest.
 * point_values NULL: values belong to cells and are fetched from `volume`, the mesh's values. */
bool stratus_tetra_shows(
  const stratus_mesh* mesh, const stratus_volume* volume, const float* point_values, double bias, int64_t cell, float range[2]);

/* tetra_layout.c: orders cells so that neighbours in space are near each other in memory, and numbers points as cells first use them. */
typedef struct stratus_tetra_places {
  int32_t* of;  /* the place of a cell */
  uint32_t* at; /* the cell at a place */
} stratus_tetra_places;

stratus_status stratus_tetra_order(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_places* places, int32_t** names);

/* tetra_march.c: convert a table's running sums for rays. The result has four parts, each for all entries, with these numbers per entry:
 * - 4: the sums up to its middle. Values are rounded to the nearest entry, and sums up to its lower end would be half an entry too low;
 * - 4: its own numbers, the differences of the table's sums;
 * - 2: the table's opaque-entry numbers, one row of all entries after the other;
 * - 2: the high and the low word (16 bits) of the sum, up to its middle, of optical depth times entry number.
 *
 * *sums is NULL if the table has no sums. */
#define STRATUS_TETRA_SUMS 12 /* ints per entry */
stratus_status stratus_tetra_sums(stratus_context* context, const stratus_table* table, int32_t** sums);

/* tetra_frame.c: sets all of a frame but its table: points in the rays' coordinates, rays by row and column; to march, also border faces by
 * tile. Buffers grow as needed and are kept for the next frame. */
stratus_status stratus_tetra_frame_prepare(stratus_context* context, const stratus_tetra_mesh* tetra, const stratus_mesh* mesh,
  const stratus_camera* camera, const stratus_image* image, bool march, stratus_tetra_buffers* buffers, stratus_tetra_frame* frame);
/* Sets how a frame's cells are drawn by its table, or by the caster's labels, and which part of rays is seen. */
void stratus_tetra_frame_shade(stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_tetra_options* options);
/* Return the transparency at which a ray may end. */
double stratus_tetra_termination(const stratus_tetra_options* options);
/* tetra_modes.c: modes that gather no light. */
stratus_status stratus_tetra_modes_check(stratus_context* context, const stratus_tetra_options* options, const stratus_mesh* mesh);
/* Whether crop regions cut rays, other than the inside or all. */
bool stratus_tetra_modes_regions(const stratus_tetra_options* options);
/* Whether nothing but marching draws with these options. */
bool stratus_tetra_modes_march(const stratus_tetra_options* options);
/* Sums for average and additive in the layout of stratus_tetra_sums(): of opacity times value, of opacity, whose moments are the last part,
 * nothing, and of the entries that count. A value is a fraction of the range of `values`. */
stratus_status stratus_tetra_value_sums(
  stratus_context* context, const stratus_table* table, const stratus_table_values* values, const double range[2], int32_t** sums);
/* Numbers of entries for first hits, where stratus_tetra_sums() has those of opaque entries: the next that shows upwards, or the table's
 * size; the next downwards, or -1. The rest is 0. */
stratus_status stratus_tetra_shown_sums(stratus_context* context, const stratus_table* table, int32_t** sums);
/* Get the planes that cut rays, in the world: clip planes, and the finite sides of the crop's box. Returns their number. */
int stratus_tetra_planes(const stratus_mesh* mesh, const stratus_tetra_options* options, double planes[TETRA_PLANES][4]);
/* Get the six planes between crop regions, the lower and the upper one along each axis, as those of points at or above them. Returns 6, or
 * 0 if no regions but the inside, or all, are cropped. */
int stratus_tetra_crop_planes(const stratus_mesh* mesh, const stratus_tetra_options* options, double planes[6][4]);
/* tetra_first_hit.c: turns the cells that rays have stored in the image into the colours and depths of their hits. */
void stratus_tetra_hits_shade(const stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_tetra_options* options, const stratus_image* image);
/* Sets mode, slice, contours and planes of a frame whose table is set. */
void stratus_tetra_frame_mode(stratus_tetra_frame* frame, const stratus_tetra_options* options);
void stratus_tetra_frame_slice(stratus_tetra_frame* frame, const stratus_tetra_options* options);
void stratus_tetra_frame_contours(
  stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options);
void stratus_tetra_frame_clip(stratus_tetra_frame* frame, const stratus_mesh* mesh, const stratus_tetra_options* options);
/* tetra_caster.c: the caster that draws the matter that absorbs light, on the host, so that host and device have the same maps; and drop
 * it, with all maps. */
stratus_status stratus_tetra_light_caster(stratus_tetra_caster* caster, stratus_tetra_caster** dark);
void stratus_tetra_shadow_drop(stratus_tetra_caster* caster);
/* tetra_shadow.c. A function as stratus_tetra_caster_render(); and the maps of a picture of this mesh alone, of layers that `dark` draws.
 */
typedef stratus_status stratus_tetra_draw(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report);
stratus_status stratus_tetra_shadow_update(
  stratus_tetra_caster* caster, const stratus_tetra_subject* of, const stratus_camera* camera, stratus_tetra_draw* draw);
/* Checks a mesh of several inputs before maps are made of it. options: may be NULL. */
stratus_status stratus_tetra_shadow_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfer, const stratus_tetra_options* options);
/* Whether a picture with these options has shadows; and a key that changes with the place of its matter. */
bool stratus_tetra_has_shadows(const stratus_mesh* mesh, const stratus_tetra_options* options);
uint64_t stratus_tetra_shadow_key(
  uint64_t key, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options);
/* stratus_lights_reflectance() of a mesh. */
double stratus_tetra_reflectance(const stratus_mesh* mesh, const stratus_tetra_options* options);
/* Makes options of the same matter without light. */
stratus_tetra_options stratus_tetra_dark_options(const stratus_tetra_options* options);
/* Makes options of the mesh without light show its albedo. materials: receives those of its components, if they have their own. */
void stratus_tetra_show_albedo(
  const stratus_tetra_options* options, int components, stratus_material materials[4], stratus_tetra_options* dark);
/* tetra_light.c: light and gradient opacity. */
stratus_status stratus_tetra_light_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options);
/* The material of component c. */
stratus_material stratus_tetra_material(const stratus_mesh* mesh, const stratus_tetra_options* options, int c);
/* Bit c where component c's gradient decides how cells look. */
unsigned stratus_tetra_light_mask(const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options);
/* Makes what is needed of gradients and factors. */
stratus_status stratus_tetra_light_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_tetra_options* options, double* ms);
void stratus_tetra_light_drop(stratus_tetra_caster* caster); /* the gradients */
void stratus_tetra_light_drop_factors(stratus_tetra_caster* caster);
/* Sets the arguments of a frame that stratus_tetra_frame_prepare() has prepared. */
void stratus_tetra_frame_light(stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_tetra_options* options);
/* tetra_components.c: values of several components that rays read together: those that mix, those that surfaces have, and dependent ones.
 */
bool stratus_tetra_mixes(const stratus_mesh* mesh, const stratus_tetra_options* options);
/* Whether rays meet surfaces, or solids, of each of several independent components. */
bool stratus_tetra_meets_components(const stratus_mesh* mesh, const stratus_tetra_options* options);
stratus_status stratus_tetra_components_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options);
stratus_status stratus_tetra_components_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfers,
  const stratus_tetra_options* options, double* ms);
void stratus_tetra_components_drop(stratus_tetra_caster* caster);
void stratus_tetra_frame_components(
  stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options);
/* tetra_labels.c: labels of cells. Build: the member transfer_count is set. */
stratus_status stratus_tetra_labels_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options);
stratus_status stratus_tetra_labels_build(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_transfer* transfers, stratus_tetra_components* m);
/* tetra_look.c: the tables of a transfer function. Return the values of a mesh for which a table is made; low..high: their range. */
stratus_table_values stratus_tetra_look_values(const stratus_mesh* mesh, float low, float high, double bias);
/* Make a look if `known` has another function, mode or range; otherwise made->table is NULL. */
stratus_status stratus_tetra_look_make(stratus_context* context, const stratus_table_values* values, const stratus_transfer* transfer,
  const stratus_tetra_options* options, const stratus_tetra_look* known, stratus_tetra_look* made);
/* Make the look of the caster's mesh in the same way. */
stratus_status stratus_tetra_look_update(
  stratus_tetra_caster* caster, const stratus_transfer* transfer, const stratus_tetra_options* options, stratus_tetra_look* made);
void stratus_tetra_look_drop(stratus_context* context, stratus_tetra_look* look);
/* tetra_parts.c: true if rays keep, cut or add the last of dependent components, in the colours of the others. */
bool stratus_tetra_draws_last(const stratus_mesh* mesh, const stratus_tetra_options* options);
/* True if each component has an image of its own. */
bool stratus_tetra_draws_parts(const stratus_mesh* mesh, const stratus_tetra_options* options);
stratus_status stratus_tetra_parts_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfers,
  const stratus_tetra_options* options, double* ms);
void stratus_tetra_parts_drop(stratus_tetra_caster* caster);
/* Exchanges what a part and the caster hold. */
void stratus_tetra_part_swap(stratus_tetra_caster* caster, stratus_tetra_part* part);
/* tetra_method.c: sets the report's method, march or project, and the reason. */
stratus_status stratus_tetra_choose(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report);
void stratus_tetra_buffers_release(stratus_context* context, stratus_tetra_buffers* buffers);
/* Grows the buffer to at least `count` elements of `size` bytes. Old contents are lost. */
stratus_status stratus_tetra_reserve(stratus_context* context, stratus_tetra_buffer* buffer, size_t count, size_t size);

#endif
