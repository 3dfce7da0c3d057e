/* SPDX-License-Identifier: BSD-3-Clause
 * The renderer of tetrahedra: what it keeps of a mesh, what a frame needs, and the steps of a render that have files of their own. */
#ifndef STRATUS_TETRA_CASTER_H
#define STRATUS_TETRA_CASTER_H

#include "volume.h"
#include "tetra_march_frame.h"
#include "tetra_march_device.h"
#include "tetra_project.h"

/* What rays read of a mesh, made once for all views. Only shown cells are linked to each other. */
typedef struct stratus_tetra_mesh {
  stratus_context* context;
  int32_t* cells;     /* TETRA_CELL*cell_count, those near each other in space near each other here */
  int32_t* names;     /* of each of the mesh's points in `cells` and `faces`, in the order in which cells come to them */
  float* values;      /* a fetched value a point; NULL where cells have them */
  float* cell_values; /* a fetched value a cell, in the order of `cells`, or NULL */
  uint8_t* shown;     /* a byte a cell */
  stratus_tetra_face* faces;
  size_t face_count;
  double lo[3], hi[3]; /* bounds of the points that shown cells use, local */
  float low, high;     /* fetched values of shown cells, low > high if there is none */
  double bias;
  int64_t cell_count, shown_cells, blanked, repeated, flat, inverted, broken, folded;
  size_t bytes;
} stratus_tetra_mesh;

struct stratus_tetra_caster {
  stratus_context* context;
  stratus_mesh view; /* what `mesh` was made from */
  stratus_tetra_mesh* mesh;
  stratus_tetra_projector* projector; /* NULL until something is projected */
  stratus_transfer* transfer;         /* a copy, NULL: none yet */
  stratus_tetra_mode mode;            /* that the table is for */
  stratus_table* table;
  int32_t* march_sums;          /* stratus_tetra_sums() */
  stratus_tetra_device* device; /* copies on the OpenCL device, NULL on the host */
  stratus_tetra_buffers buffers;
  uint64_t mesh_builds, table_builds;
};

/* tetra_mesh.c. The mesh passed stratus_mesh_check() and has values. */
stratus_status stratus_tetra_mesh_create(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_mesh** out);
void stratus_tetra_mesh_destroy(stratus_tetra_mesh* mesh); /* takes NULL */
/* Whether a cell is drawn: it is not hidden, names four points, and its values are finite. range: the least and the greatest of them. A
 * point has its value in point_values; NULL: cells have values, fetched from `volume`, the mesh's. */
bool stratus_tetra_shows(
  const stratus_mesh* mesh, const stratus_volume* volume, const float* point_values, double bias, int64_t cell, float range[2]);

/* tetra_layout.c: a place for each cell, neighbours in space near each other, and a name for each point by the first cell that has it. */
typedef struct stratus_tetra_places {
  int32_t* of;  /* a cell's place */
  uint32_t* at; /* the cell at a place */
} stratus_tetra_places;

stratus_status stratus_tetra_order(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_places* places, int32_t** names);

/* tetra_march.c: running sums of a table up to the middle of each entry, for values are rounded to the nearest one: up to its lower end all
 * would be taken as half an entry too low. Behind them what each entry is by itself. Four of an entry side by side. Then the table's two
 * rows of opaque entries. NULL where it has none. */
#define STRATUS_TETRA_SUMS 10 /* ints an entry */
stratus_status stratus_tetra_sums(stratus_context* context, const stratus_table* table, int32_t** sums);

/* tetra_frame.c: points in the rays' coordinates, rays of rows and columns; to march also border faces by tile. Buffers grow and are kept.
 */
stratus_status stratus_tetra_frame_prepare(stratus_context* context, const stratus_tetra_mesh* tetra, const stratus_mesh* mesh,
  const stratus_camera* camera, const stratus_image* image, bool march, stratus_tetra_buffers* buffers, stratus_tetra_frame* frame);
/* tetra_method.c: march or project, and the reason. */
stratus_tetra_method stratus_tetra_choose(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_camera* camera,
  const stratus_tetra_options* options, const stratus_image* image, char* why, size_t capacity);
void stratus_tetra_buffers_release(stratus_context* context, stratus_tetra_buffers* buffers);
/* At least `count` elements of `size` bytes in *memory, whose old contents are lost. */
stratus_status stratus_tetra_reserve(stratus_context* context, stratus_tetra_buffer* buffer, size_t count, size_t size);

#endif
