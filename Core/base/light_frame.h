/* SPDX-License-Identifier: BSD-3-Clause
 * Where the nodes of a map of light are. Coordinates are those of the light: across, up, and along its way. Of a position the first two
 * are slopes. The map of a position in the matter has six faces, the sides of a cube: +x -x +y -y +z -z. Across and up of a face are the
 * two axes that follow the one that it looks along. */
#ifndef STRATUS_LIGHT_FRAME_H
#define STRATUS_LIGHT_FRAME_H

#include "stratus/ray_cast.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct stratus_light_frame {
  double basis[3][3], origin[3];
  double lo[3], hi[3];
  bool perspective;
  int faces; /* 0 of a direction */
} stratus_light_frame;

static inline size_t stratus_light_faces(const stratus_light_frame* f)
{
  return f->faces > 0 ? (size_t)f->faces : 1;
}

/* Gives the axes of a face in the world: across, up and along. */
static inline void stratus_light_face_basis(const stratus_light_frame* f, int face, double basis[3][3])
{
  memcpy(basis, f->basis, sizeof f->basis);
  if (f->faces == 6) {
    const int along = face / 2;
    memset(basis, 0, sizeof f->basis);
    basis[0][(along + 1) % 3] = basis[1][(along + 2) % 3] = 1.0;
    basis[2][along] = face & 1 ? -1.0 : 1.0;
  }
}

/* Places a map of a light, given in the world, about matter within the bounds: xmin xmax ymin ymax zmin zmax. sides: receives the lengths
 * of its sides in the world. */
void stratus_light_frame_place(const stratus_light* light, const double bounds[6], stratus_light_frame* frame, double sides[3]);

/* Takes a place in the world to the light's coordinates. Returns its face. */
int stratus_light_frame_coordinates(const stratus_light_frame* frame, const double world[3], double q[3]);

/* The part of light, by the words of a map, that passes to a place of a face, in steps of its nodes and layers. */
float stratus_light_passing(const int size[3], const int32_t* words, int face, const double place[3]);

#endif
