/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes in layers, as models of the ocean and of the air write them: faces between nodes on a surface, and in each layer a prism above
 * each face. Layers, and the borders below and above them, count from the bottom up. Arrays over layers or borders and nodes have nodes
 * fastest.
 */
#ifndef STRATUS_PUBLIC_LAYERS_H
#define STRATUS_PUBLIC_LAYERS_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STRATUS_FACE_NODES_MAX 64

/* Faces between nodes. The arrays are the caller's. */
typedef struct stratus_faces {
  int64_t node_count; /* 1..2^31-1 */
  int64_t face_count; /* 1..2^31-1 */
  int64_t* offsets;   /* face_count + 1: the nodes of face f are nodes[offsets[f]] to nodes[offsets[f + 1] - 1] */
  int32_t* nodes;
  uint8_t*
    absent; /* one flag for each face. 1: it has too few nodes and is not there; its nodes are three times node 0. NULL: all are there */
} stratus_faces;

/* A file's table of the nodes of each face, or of the faces around each node. */
typedef struct stratus_face_table {
  const double* numbers; /* rows * columns, columns fastest; NaN: none */
  int64_t rows;          /* the faces, or the nodes */
  int64_t columns;       /* 1..STRATUS_FACE_NODES_MAX */
  double first;          /* the number of the first node, or of the first face */
  int rows_are_nodes;    /* 0: a row lists the nodes of a face in their order. 1: a row lists the faces around a node in any order */
  int fewest;            /* 3..STRATUS_FACE_NODES_MAX: a face of fewer nodes is absent. 0: a row of fewer than 3 nodes is an error */
} stratus_face_table;

/* Find the nodes of faces. A node that comes twice in succession counts once.
 * - faces: node_count and face_count are given; the arrays receive the faces. `nodes` has room for rows * columns + 3 * face_count numbers
 */
STRATUS_API stratus_status stratus_faces_from_table(stratus_context* context, const stratus_face_table* table, stratus_faces* faces);
/* Number places on the sphere, of which those at one point are one node: places less than 10^-6 radians from each other, some six metres.
 * - count: 1..2^31-1
 * - degrees: longitude and latitude of each place, finite
 * - numbers: receives the number of each place, 0 and up in the order in which nodes first come
 * - first: receives the index of the first place of each node; has room for `count`
 * - node_count: receives the number of nodes */
STRATUS_API stratus_status stratus_faces_join_corners(
  stratus_context* context, int64_t count, const double* degrees, int32_t* numbers, int64_t* first, int64_t* node_count);
/* Turn faces so that their nodes are counterclockwise, seen from above.
 * - faces: only the order of `nodes` within each face is changed
 * - places: two numbers for each node: x and y, or longitude and latitude in degrees
 * - on_sphere: 1: the places are on a sphere, seen from outside. 0: on a plane */
STRATUS_API stratus_status stratus_faces_turn(stratus_context* context, const stratus_faces* faces, const double* places, int on_sphere);

/* Find values at nodes from values of faces: means over the faces around each node that are there and have a value.
 * - values: one for each face; NaN: none
 * - at_nodes: receives one for each node; NaN: no face around it has a value */
STRATUS_API stratus_status stratus_faces_to_nodes(
  stratus_context* context, const stratus_faces* faces, const double* values, double* at_nodes);

/* Faces on the plane of longitudes and latitudes. A place of the Earth is in one face at most, and no face reaches across the meridian of a
 * cut. The arrays are the core's, until stratus_flat_faces_destroy(). */
typedef struct stratus_flat_faces {
  stratus_faces faces; /* first the mesh's nodes and faces in their order, then nodes of cuts and poles, and further parts of cut faces */
  double* degrees;     /* longitude and latitude of each node */
  int32_t* node_of;    /* two nodes of the mesh for each node: the same one twice, or the ends of the edge that it is on */
  double* weights;     /* of the first of these, 0..1; the second has 1 - weight */
  int32_t* face_of;    /* the face of the mesh that each face is a part of */
  int unwrapped;       /* 1: whole turns were added to longitudes, so that they are continuous all over the mesh */
  int cut;             /* 1: the mesh goes round the Earth or a pole. Longitudes are meridian to meridian + 360 */
  double meridian;     /* of the cut, degrees: 0 if the mesh has longitudes above 180, otherwise -180. 0 without a cut */
} stratus_flat_faces;

/* Put faces of longitudes and latitudes on a plane.
 * - If no edge jumps by more than 180 degrees of longitude, longitudes stay.
 * - If whole turns make longitudes continuous, they are added. A part of the mesh that no edge joins to the widest part is as near to that
 *   as whole turns allow.
 * - Otherwise the mesh goes round the Earth, and faces are cut at a meridian. Values at a cut are between the edge's ends, by distance. If
 *   the meridian crosses a concave face more than twice, its pieces on one side are one face, with edges along the meridian.
 * - A corner within 10^-4 degrees of a pole becomes an edge at the longitudes of its neighbours, because a pole is a line on the plane.
 * - A face around a pole becomes quadrangles between each of its edges and the pole, which must see all of these edges. Values at the pole
 *   equal the values of the face's nearest node.
 * - A part of more than STRATUS_FACE_NODES_MAX nodes becomes several faces.
 *
 * - faces: in any orientation. Edges are shorter than 180 degrees of longitude, unless they end at a pole
 * - degrees: longitude, -10^6..10^6, and latitude, -90..90, of each node
 * - flat: receives the faces, which keep their orientation; stratus_faces_turn() makes it counterclockwise */
STRATUS_API stratus_status stratus_faces_flatten(
  stratus_context* context, const stratus_faces* faces, const double* degrees, stratus_flat_faces* flat);
/* Release the arrays of faces that stratus_faces_flatten() made, and clear the struct. NULL, and a cleared one, are allowed. */
STRATUS_API void stratus_flat_faces_destroy(stratus_context* context, stratus_flat_faces* flat);

/* Find the borders of layers from their middles: midway between these. The outermost ones are as far from the outermost middle as the next
 * border, but not beyond height 0 if all middles are on one side of it. A single layer is one metre thick.
 * - middles: layer_count heights, ascending
 * - borders: receives layer_count + 1 heights */
STRATUS_API stratus_status stratus_layers_between(stratus_context* context, int64_t layer_count, const double* middles, double* borders);

/* Heights of layers' borders, which stay between a bottom and a surface. The arrays are borrowed. */
typedef struct stratus_layer_borders {
  int64_t node_count, layer_count; /* each >= 1 */
  const double* borders;           /* layer_count + 1, ascending: heights, or of sigma -1 at the bottom to 0 at the surface */
  int of_nodes;                    /* 1: `borders` has a value for each border and node. 0: for each border */
  int sigma;                       /* 1: `borders` are of sigma */
  int stretched;                   /* 1: the lowest border is at the bottom even if that is lower */
  const double* bottom;            /* heights at nodes; NaN: there are no layers. NULL: no bottom; sigma needs both */
  const double* surface;           /* the same; the uppermost border is at the surface even if that is higher */
} stratus_layer_borders;

/* Find the heights of borders at nodes.
 * - z: receives the height of each border at each node
 * - none: receives for each node 1 if there are no layers, which is also so if the surface is not above the bottom */
STRATUS_API stratus_status stratus_layers_from_borders(
  stratus_context* context, const stratus_layer_borders* from, double* z, uint8_t* none);
/* Find the heights of borders at nodes from heights that a file has there.
 * - of_borders: 1: `heights` are the borders', layer_count + 1 for each node. 0: the middles' of layers, layer_count for each node
 * - heights: ascending; NaN: none, which becomes the next one above it
 * - z, none: as stratus_layers_from_borders(); a node without any height has no layers */
STRATUS_API stratus_status stratus_layers_from_heights(
  stratus_context* context, int64_t node_count, int64_t layer_count, int of_borders, const double* heights, double* z, uint8_t* none);
/* Find the heights of borders at nodes from thicknesses of layers above a bottom.
 * - thicknesses: of each layer and node; a value that is not above 0 is no layer
 * - bottom: height at each node; NaN: there are no layers
 * - present: how many layers each node has, from the top down. NULL: all
 * - z, none: as stratus_layers_from_borders() */
STRATUS_API stratus_status stratus_layers_from_thicknesses(stratus_context* context, int64_t node_count, int64_t layer_count,
  const double* thicknesses, const double* bottom, const double* present, double* z, uint8_t* none);
/* Find values at borders from values in the middle of layers, by distance. NaN does not count.
 * - z: the heights of borders
 * - values: of each layer and node
 * - at_borders: receives a value for each border and node */
STRATUS_API stratus_status stratus_layers_to_borders(
  stratus_context* context, int64_t node_count, int64_t layer_count, const double* z, const double* values, double* at_borders);

/* Find the prisms that are not there: those of absent faces, at nodes without layers, and without thickness. Prism layer * face_count +
 * face is above the face.
 * - z, none: of each border and node, of each node. none: NULL: all nodes have layers
 * - hidden: receives one flag for each prism */
STRATUS_API stratus_status stratus_prisms_hide(
  stratus_context* context, const stratus_faces* faces, int64_t layer_count, const double* z, const uint8_t* none, uint8_t* hidden);
/* Divide prisms into tetrahedra, of which neighbours have whole faces in common. Points are the nodes of each border: number border *
 * node_count + node.
 * - faces: counterclockwise
 * - hidden: one flag for each prism: not 0 leaves it out. NULL: none
 * - count: receives the number of tetrahedra, at most 2^30-1
 * - vertices, prisms: receive four points of each tetrahedron, and its prism. Both NULL: only count */
STRATUS_API stratus_status stratus_prisms_divide(stratus_context* context, const stratus_faces* faces, int64_t layer_count,
  const uint8_t* hidden, int64_t* count, int32_t* vertices, int32_t* prisms);

#ifdef __cplusplus
}
#endif

#endif
