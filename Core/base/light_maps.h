/* SPDX-License-Identifier: BSD-3-Clause
 * Maps of the light that passes to the places in a scene, in the layout of kernels/base/light_map.h. */
#ifndef STRATUS_LIGHT_MAPS_H
#define STRATUS_LIGHT_MAPS_H

#include "base.h"
#include "light_arguments.h"
#include "light_scatter.h"
#include "stratus/ray_cast.h"

typedef struct stratus_light_maps stratus_light_maps;
struct _cl_mem;

/* The matter that absorbs light. */
typedef struct stratus_light_matter {
  stratus_light_draw* draw;
  void* of;
  double bounds[6]; /* world coordinates: xmin xmax ymin ymax zmin zmax */
  bool together;    /* whether it is drawn fastest in many layers at a time */
  /* steps at which a renderer can pass the matter next to a place by itself; 0: it cannot */
  double step;
  double detail;      /* length of the finest cells in which it scatters light again; 0: not known */
  double reflectance; /* of a light, the matter sends to the eye at most this times the colour that `draw` shows */
  double tolerance;   /* of pictures, root mean square over the matter; 0: as fine as maps can be */
  double reach;       /* the length within which matter hides a light from a place; 0: the whole way */
} stratus_light_matter;

/* Build the maps of all lights, given in the world. If light is scattered more than once, solve for it, too. A map has the least of 32, 64,
 * 128 and 256 nodes along its longest side whose expected error keeps its light's share of the tolerance, if need be with near matter
 * passed by rays, and at most 64 MiB: each face of a cube of maps has at most 128. *maps: NULL or maps to replace; after a failure it is as
 * before.
 */
stratus_status stratus_light_maps_build(stratus_context* context, const stratus_light_matter* matter, const stratus_shading* shading,
  const stratus_light* lights, int count, stratus_light_maps** maps);
/* Sets the surfaces that hide the lights, in place of those before. NULL: there are none. If it fails, those before are kept. */
stratus_status stratus_light_maps_hide(stratus_light_maps* maps, const stratus_surfaces* surfaces);
void stratus_light_maps_destroy(stratus_light_maps* maps);

/* The maps of a scene that is drawn again and again. */
typedef struct stratus_light_state {
  stratus_light_maps* maps; /* NULL: none */
  uint64_t key;             /* of the matter that they were built of */
  uint64_t builds;
} stratus_light_state;

/* Whether there are maps of matter with this key and of exactly these lights' ways, as exact as their colours need. If so, takes over the
 * colours. */
bool stratus_light_state_serves(stratus_light_state* state, uint64_t key, const stratus_light* lights, int count);
/* Builds the maps anew. The key is then 0, until the caller sets it. */
stratus_status stratus_light_state_build(stratus_context* context, const stratus_light_matter* matter, const stratus_shading* shading,
  const stratus_light* lights, int count, stratus_light_state* state);
void stratus_light_state_drop(stratus_light_state* state);
/* A key that follows from another and from bytes. The first is 0. */
uint64_t stratus_light_key(uint64_t key, const void* bytes, size_t count);
/* The key of surfaces by their address, count and revision. 0: there are none. */
uint64_t stratus_light_key_of_surfaces(const stratus_surfaces* surfaces);
/* A key that follows from another and from transfer functions, their points included. */
uint64_t stratus_light_key_of_transfers(uint64_t key, const stratus_transfer* transfers, int count);
/* The same of the shadows' length; of lights and the sky, if light is scattered more than once; and of the albedo of matter but for the
 * shading's diffuse number. materials: of `components`; NULL: none of their own. */
uint64_t stratus_light_key_of_scattering(uint64_t key, const stratus_shading* shading, const stratus_light* lights, int count);
uint64_t stratus_light_key_of_albedo(
  uint64_t key, const stratus_transfer* transfers, int count, const stratus_material* materials, int components);

/* Sets the maps of the lights that have one, and none for the others. maps: NULL: there is none. lights: in the world, as many as the
 * arguments have. to_world: 4x4, from the places that rays have to the world. unit: of the arguments' `place`, in the world.
 * sample_distance: by which near_length is counted; 0: the rays do not pass near matter by themselves. */
void stratus_light_maps_arguments(const stratus_light_maps* maps, const stratus_light* lights, const double to_world[16], double unit,
  double sample_distance, stratus_light_arguments* a);

/* The part of light i, given in the world, that the matter lets pass to a place in the world, which may be outside of it. */
double stratus_light_maps_passing(const stratus_light_maps* maps, const stratus_light* light, int i, const double world[3]);

/* The words of all maps, NULL without maps; their bytes; the error that is expected of a picture by them; and the longest way, in the
 * world, on which near matter is passed. */
const int32_t* stratus_light_maps_words(const stratus_light_maps* maps);
size_t stratus_light_maps_bytes(const stratus_light_maps* maps);
double stratus_light_maps_error(const stratus_light_maps* maps);
double stratus_light_maps_near(const stratus_light_maps* maps);
/* Gives the buffer of the words on the context's device, an OpenCL memory object. All casters read this one. It belongs to the maps. *sent:
 * the device had no copy before. */
stratus_status stratus_light_maps_on_device(const stratus_light_maps* maps, struct _cl_mem** memory, bool* sent);

#endif
