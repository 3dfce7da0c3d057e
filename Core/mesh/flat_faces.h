/* SPDX-License-Identifier: BSD-3-Clause
 * The nodes and faces of a mesh on a plane while they are being made. */
#ifndef STRATUS_FLAT_FACES_H
#define STRATUS_FLAT_FACES_H

#include "faces.h"

#define FLAT_NEAR_POLE 1e-4 /* degrees, some ten metres: a node that is nearer to a pole is at it */
#define FLAT_FARTHEST 1e6   /* degrees of longitude */

/* A node on the plane. Those behind the mesh's own are found again by their key. */
typedef struct flat_node {
  double x, y;           /* degrees */
  int32_t first, second; /* nodes of the mesh between which it is */
  double weight;         /* of the first */
  int32_t key[2];        /* nodes on the plane of which it is a copy, or between which it is, at this longitude */
  int32_t next;          /* in its bucket, -1: none */
} flat_node;

/* Faces one after the other. */
typedef struct flat_list {
  int64_t count;
  int64_t* ends; /* of each face, in `nodes` */
  int32_t* of;   /* the face of the mesh that each is a part of */
  int32_t* nodes;
  int64_t room, node_room, of_room;
} flat_list;

typedef struct flat_builder {
  stratus_context* context;
  bool around;           /* the mesh goes round the Earth, and is cut at `west` */
  double west;           /* longitudes are from here on, over less than a turn */
  flat_node* nodes;      /* the mesh's nodes first */
  int64_t count, room;   /* of nodes */
  int64_t own;           /* nodes of the mesh */
  int32_t* buckets;      /* the last node of each, -1: none */
  int64_t bucket_count;  /* a power of two; 0: there are none yet */
  flat_list first, more; /* a part of each face of the mesh, and further parts */
} flat_builder;

/* Begins with the mesh's nodes. */
stratus_status stratus_flat_begin(flat_builder* b, const stratus_faces* faces, const double* degrees);
/* Finds the copy of a node at another longitude, or the node itself. */
stratus_status stratus_flat_copy(flat_builder* b, int32_t node, double longitude, int32_t* found);
/* Finds the node where a meridian meets the edge between two nodes, which are at these longitudes on both sides of it. */
stratus_status stratus_flat_between(flat_builder* b, const int32_t nodes[2], const double longitudes[2], double meridian, int32_t* found);
/* Adds a node at the pole that is nearest to a node, whose values it has. */
stratus_status stratus_flat_pole(flat_builder* b, int32_t node, int32_t* added);
/* Adds a part of a face. Faces come in ascending order. */
stratus_status stratus_flat_add(flat_builder* b, int64_t face, const int32_t* nodes, int count);
/* Makes the arrays of `flat`. */
stratus_status stratus_flat_end(flat_builder* b, const stratus_faces* faces, stratus_flat_faces* flat);
void stratus_flat_release(flat_builder* b);

#endif
