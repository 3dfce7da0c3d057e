/* SPDX-License-Identifier: BSD-3-Clause
 * The state of a packet of rays through several volumes: the data of each volume that all rays read, and the rays' places in it. */
#ifndef STRATUS_SEVERAL_STATE_H
#define STRATUS_SEVERAL_STATE_H

#include "crop.h"
#include "lighting.h"
#include "ray_several_arguments.h"
/* 1: there is a mesh of tetrahedra. A device compiles the code for meshes only then, as for all that follows. */
#ifndef SEVERAL_MESHES
#ifdef STRATUS_DEVICE
#define SEVERAL_MESHES 0
#else
#define SEVERAL_MESHES 1
#endif
#endif
#if SEVERAL_MESHES
#include "tetra_tile.h"
#endif
/* 1: some mesh has light, gradient opacity or several components. */
#if SEVERAL_MESHES && TETRA_LIT
#define SEVERAL_LIT_MESHES 1
#else
#define SEVERAL_LIT_MESHES 0
#endif
/* 1: some volume has rays that go from cell to cell. */
#ifndef SEVERAL_CELLS
#define SEVERAL_CELLS 1
#endif
/* 1: some volume is of several media. */
#ifndef SEVERAL_MEDIA
#define SEVERAL_MEDIA 1
#endif
#if SEVERAL_CELLS
#include "cell_way.h"
#include "local_runs.h"
#endif
/* Whether there may be sources of stretches. */
#define SEVERAL_STRETCHES (SEVERAL_CELLS || SEVERAL_MESHES)

/* A device compiles a kernel for as many volumes as there are. */
#ifndef SEVERAL_MOST
#define SEVERAL_MOST 8
#endif
/* Volumes, and the further pieces of those that crop regions cut. Each piece marches as a volume of its own. */
#ifndef SEVERAL_PARTS
#define SEVERAL_PARTS (CROP_PIECES * SEVERAL_MOST)
#endif
#define SEVERAL_NEVER 0x7fffffff
/* Where something has shown for so many segments, the structure is asked a segment later than it has to be. */
#define SEVERAL_LOOKS 8
/* Place of a ray that has no stretch left. */
#define SEVERAL_BEYOND 1e30f
/* Segments between a ray's places are ints. */
#define SEVERAL_SEGMENTS_MOST 1e9

/* Numbers of the lattice's segments from the eye on. */
#ifdef STRATUS_DEVICE
typedef long several_number_t;
#else
typedef int64_t several_number_t;
#endif
#define SEVERAL_FARTHEST 4e18f

#if SEVERAL_MESHES
/* The data of a mesh of tetrahedra that all rays read. */
typedef struct several_mesh {
  stratus_tetra_view view;
  CONSTANT stratus_tetra_arguments* a;
  CONSTANT stratus_several_places* places;
} several_mesh;

/* Whether a mesh has components or labels: their rates are constant in a piece, and are not integrated between values. */
INLINE int several_mesh_is_mixed(const several_mesh* m) { return m->a->media.components | m->a->media.labels; }

typedef struct several_mesh_rays {
  stratus_tetra_walk walk;
  stratus_tetra_lanes lanes;
  vfloat base, scale; /* segments from the one in which the ray enters are base + scale z */
  vfloat reached;     /* where the last stretch ends */
#if SEVERAL_LIT_MESHES
  /* the part of a cell that a ray sees: its gradients and, of several, the values of components; the path is from lo to hi, and of one
   * component values are from front to back */
  stratus_tetra_stretch stretches[TETRA_COMPONENTS];
  stratus_tetra_values values;
  vfloat lo, hi, front, back, length; /* length: in the world */
  vint label;                         /* the cell's, of a mesh of labels */
  vfloat piece, pieces;               /* the next of its pieces, and their number */
  vfloat ends;                        /* where the present piece ends */
  /* the rest of a piece from wall_lo to wall_hi behind a wall that gradient opacity over a length has thinned, and its rate; none where
   * wall_lo is not below wall_hi */
  vfloat wall_lo, wall_hi, wall_rate[4];
#endif
} several_mesh_rays;
#endif

/* The data of a volume that all rays read. */
typedef struct several_source {
  CONSTANT stratus_ray_cast_arguments* a;
  value_source values;
  GLOBAL const uchar *hidden, *map, *rough;
  GLOBAL const int *grid, *lights;
  /* table: pre-integrated, the running sums; midpoint, for each entry its colour times optical depth, and its optical depth, over one
   * segment. besides: with light or gradient opacity, the tables that these read. */
  GLOBAL const void *table, *besides;
#if SEVERAL_MESHES
  const several_mesh* mesh; /* 0: a volume */
#endif
  int piece;         /* of those that crop regions cut rays into */
  int stride;        /* segments of the lattice to a sample of this volume, at least 1 */
  int lit;           /* 1: it has light or gradient opacity, or is a mesh of several components */
  int cells;         /* SEVERAL_BY_SAMPLES, SEVERAL_BY_CELLS or SEVERAL_LOCAL */
  int media;         /* SEVERAL_COMPONENTS, SEVERAL_LABELS or SEVERAL_FUNCTION_2D; 0: each sample is one value's colour and opacity */
  float segment;     /* media: a segment's length in samples, for which its table is made */
  int preintegrated; /* 1: a sample is integrated between the values at both ends of its path; 0: it has the value in the middle */
} several_source;

/* A path: the part of each ray from `lo` to `hi`, and a volume's values on it. Places are in segments from the segment in which the ray
 * enters the volume. */
typedef struct several_way {
  vfloat lo, hi, front, rise; /* the field changes from `front` at lo to `front` + `rise` at hi */
  vfloat rate[4];             /* colour times optical depth, and optical depth, for one segment's length */
  vfloat entries;             /* entries of the table for each segment's length of the path */
  vmask stops;                /* rays that end at hi, in the colour `wall` */
  vfloat wall[3];
  stratus_lit_sample lighting; /* set if the volume has light or gradient opacity */
} several_way;

#if SEVERAL_CELLS
/* State of rays that go from cell to cell, at least in rough blocks. In smooth blocks walk.s is where the next sample begins. */
typedef struct several_cells_rays {
  cell_walk walk; /* its end is the end of the run that rays are on */
  cell_way way;   /* through the cell where the walk is */
  vmask waiting;  /* rays that have pieces of `way` left */
  vmask rough;    /* rays that go from cell to cell */
  vfloat end;     /* where rays end */
  vfloat began;   /* where rays began to take samples */
} several_cells_rays;
#endif

typedef struct several_volume {
  stratus_packet k; /* the rays in this volume's coordinates */
  vint offset;      /* the packet's number for the segment in which a ray enters */
  vint phase;       /* segments from the beginning of a sample's path to the one in which a ray enters */
  /* the segments, by the packet's numbers, from which on and up to which the structure has something to show; before shown_from nothing
   * shows, and from shown_until on nothing is known yet */
  vint shown_from, shown_until;
  int began;     /* the segment since which the volume has been sampled */
  int next, run; /* the segment at which a sample or a look-up is due; before `run` the structure need not be read */
  int last;      /* the first segment behind all rays' ends */
  vfloat ahead;  /* pre-integrated: the value at the path's end, which is the front value of the next path */
  vmask knows;   /* the rays for which `ahead` is known */
  several_way ways[2];
  int now;          /* index in `ways` of the path that rays are on; the other is the coming path */
  int shows, comes; /* whether anything shows on the present path, and on the coming one */
#if SEVERAL_CELLS
  several_cells_rays cells;
#endif
#if SEVERAL_MESHES
  several_mesh_rays mesh;
#endif
} several_volume;

/* Whether its paths are stretches that begin and end within segments: paths through a mesh, or through a volume cell by cell. */
INLINE int several_has_stretches(const several_source* from)
{
#if SEVERAL_MESHES
  if (from->mesh) {
    return 1;
  }
#endif
  return SEVERAL_CELLS && from->cells;
}

/* Adds the further pieces of volumes that crop regions cut, behind the volumes. Returns the number of all. */
INLINE int several_add_pieces(several_source* from, int count)
{
  int parts = count;
  for (int n = 0; n < count; ++n) {
    int regions = RAY_RARE(RAY_REGIONS, from[n].a->crop.regions);
#if SEVERAL_MESHES
    if (from[n].mesh) {
      regions = from[n].mesh->a->regions;
    }
#endif
    from[n].piece = 0;
    for (int piece = 1; regions && piece < CROP_PIECES && parts < SEVERAL_PARTS; ++piece) {
      from[parts] = from[n];
      from[parts++].piece = piece;
    }
  }
  return parts;
}

/* The field, and its gradient, at x. */
INLINE vfloat several_value_at(const several_source* from, const vfloat x[3], vmask mask)
{
  return RAY_NAME(ray_value)(from->a, from->values, from->hidden, from->grid, x, mask);
}

INLINE void several_gradient_at(const several_source* from, const vfloat x[3], vmask mask, vfloat g[3])
{
  RAY_NAME(ray_gradient)(from->a, from->values, from->grid, x, mask, g);
}

#if SEVERAL_CELLS
INLINE void several_corners_at(const several_source* from, const vint at[3], vmask mask, vfloat v[8])
{
  RAY_NAME(fetch_cell)(from->a, from->values, at[0], at[1], at[2], mask, v);
}

INLINE vfloat several_nearest_at(const several_source* from, const vint at[3], vmask mask)
{
  return RAY_NAME(fetch_nearest)(from->a, from->values, at[0], at[1], at[2], mask);
}
#endif

#if SEVERAL_MEDIA
/* Fill `rate` with the colour and optical depth of samples over a segment's length, on the live rays of k. */
INLINE void several_media_at(const several_source* from, const stratus_packet* k, const stratus_sample* sample, vfloat rate[4])
{
  RAY_NAME(several_media)(from->a, from->media, from->segment, from->besides, k, sample, rate);
}
#endif

/* The smallest number in the lanes of the mask. */
INLINE int several_least(vint a, vmask mask)
{
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return _mm512_mask_reduce_min_epi32(mask, (__m512i)a);
#else
  int lanes[STRATUS_WIDTH], least = SEVERAL_NEVER;
  vi_store(lanes, vi_select(mask, a, vi_set(SEVERAL_NEVER)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    least = lanes[lane] < least ? lanes[lane] : least;
  }
  return least;
#endif
}

/* The largest number in the lanes of the mask, of numbers above -SEVERAL_NEVER; -SEVERAL_NEVER if there is none. */
INLINE int several_most(vint a, vmask mask) { return -several_least(vi_set(0) - a, mask); }

/* The number of the sample, of `stride` segments each, in which segment i is. */
INLINE vint several_sample_of(const several_source* from, vint i)
{
  const vint stride = vi_set(from->stride), zero = vi_set(0), one = vi_set(1);
  vint sample = v_to_int((v_from_int(i) + v_set(0.5f)) * v_set(1.0f / (float)from->stride));
  const vint rest = i - sample * stride; /* the product is rounded */
  sample = sample + vi_select(vi_ge(rest, stride), one, vi_select(vi_lt(rest, zero), zero - one, zero));
  return sample;
}

/* The segments in which the paths of the samples begin that have segments i of the rays. */
INLINE vint several_aligned_rays(const several_source* from, const several_volume* v, vint i)
{
  if (from->stride > 1) {
    i = several_sample_of(from, i + v->phase) * vi_set(from->stride) - v->phase;
  }
  return i;
}

#endif
