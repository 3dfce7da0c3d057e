/* SPDX-License-Identifier: BSD-3-Clause
 * Checks of faces between nodes. */
#ifndef STRATUS_FACES_H
#define STRATUS_FACES_H

#include "base.h"
#include "stratus/layers.h"

/* Fails unless pointers and counts are valid. */
stratus_status stratus_faces_check(stratus_context* context, const stratus_faces* faces);
/* Also fails unless each face has 3 to STRATUS_FACE_NODES_MAX nodes that are there. */
stratus_status stratus_faces_check_nodes(stratus_context* context, const stratus_faces* faces);

#endif
