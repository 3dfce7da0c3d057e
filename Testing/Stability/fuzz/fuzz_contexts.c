/* SPDX-License-Identifier: BSD-3-Clause
 * Contexts with any options, and all calls that need no object: names, devices, cameras, frusta, checks, unknown scenes of record. */
#include "stratus.h"
#include "tree.h"
#include "octree.h"

#include "fuzz.h"

#include <stdlib.h>

static void ask_names(fuzz* f)
{
  const int any = fuzz_chance(f, 0.5) ? (int)fuzz_below(f, 14) : (int)(uint32_t)(uint64_t)fuzz_odd_integer(f);
  EXPECT(CALL(stratus_status_name((stratus_status)any)) && CALL(stratus_structure_name((stratus_structure)any)), "no name");
  EXPECT(CALL(stratus_sampling_name((stratus_sampling)any)) && CALL(stratus_mode_name((stratus_mode)any)), "no name");
  EXPECT(CALL(stratus_field_method_name((stratus_field_method)any)) && CALL(stratus_tree_method_name((stratus_tree_method)any)), "no name");
  EXPECT(CALL(stratus_tetra_method_name((stratus_tetra_method)any)), "no name");
  EXPECT(CALL(stratus_type_size((stratus_type)any)) <= 8, "a type of more than 8 bytes");
  const bool scene = any >= 0 && any < CALL(stratus_scene_count()), voxels = any >= 0 && any < CALL(stratus_voxel_scene_count());
  EXPECT((CALL(stratus_scene_name(any)) != NULL) == scene, "scene %d", any);
  EXPECT((CALL(stratus_voxel_scene_name(any)) != NULL) == voxels, "voxel scene %d", any);
  EXPECT((CALL(stratus_mesh_scene_name(any)) != NULL) == (any >= 0 && any < CALL(stratus_mesh_scene_count())), "mesh scene %d", any);
}

static void ask_devices(fuzz* f)
{
  const int count = CALL(stratus_device_count()),
            index = fuzz_chance(f, 0.5) ? (int)fuzz_below(f, 3) : (int)(uint32_t)(uint64_t)fuzz_odd_integer(f);
  const size_t capacity = fuzz_below(f, 40);
  char* name = fuzz_output(f, capacity);
  char* given = fuzz_odd(f) ? NULL : name;
  const stratus_status status = CALL(stratus_device_name(index, given, capacity));
  const stratus_status wanted = !given || capacity == 0 ? STRATUS_INVALID_ARGUMENT
    : index >= 0 && index < count                       ? STRATUS_OK
                                                        : STRATUS_NO_DEVICE;
  EXPECT(status == wanted, "device %d: %s", index, stratus_status_name(status));
}

/* Calls without a status take a NULL object for an empty one; calls with a status refuse it. */
static void ask_nothing(fuzz* f)
{
  const stratus_status bad = STRATUS_INVALID_ARGUMENT;
  int64_t n[3] = { 7, 7, 7 }, m[3] = { 7, 7, 7 };
  double low = 0.0, high = 0.0;
  int size = 0;
  CALL(stratus_value_range_blocks(NULL, fuzz_pointer(f, n) ? n : NULL, &size));
  CALL(stratus_value_range_block(NULL, 0, 0, 0, &low, &high, &size));
  CALL(stratus_value_range_block(NULL, 0, 0, 0, NULL, NULL, NULL));
  EXPECT(CALL(stratus_value_range_whole(NULL, &low, &high)) == bad, "a range of nothing");
  CALL(stratus_occupancy_blocks(NULL, n, NULL));
  CALL(stratus_occupancy_bounds(NULL, n, m));
  CALL(stratus_occupancy_bounds(NULL, NULL, NULL));
  EXPECT(CALL(stratus_occupancy_count(NULL)) == 0 && CALL(stratus_occupancy_get(NULL, 0, 0, 0)) == 0, "nothing is occupied");
  EXPECT(CALL(stratus_distance_map_get(NULL, 0, 0, 0, 0)) == 0 && CALL(stratus_distance_map_bytes(NULL)) == 0, "a map of nothing");
  CALL(stratus_voxels_dimensions(NULL, n));
  CALL(stratus_voxels_bounds(NULL, n, NULL));
  EXPECT(CALL(stratus_voxels_count(NULL)) == 0 && CALL(stratus_voxels_get(NULL, 0, 0, 0)) == 0, "voxels of nothing");
  (void)CALL(stratus_field_get(NULL, 0, 0, 0));
  CALL(stratus_field_distances(NULL, NULL));
  EXPECT(CALL(stratus_field_rgba(NULL, NULL, NULL)) == bad, "a field of nothing");
  stratus_tree_statistics t;
  CALL(stratus_tree_get_statistics(NULL, &t));
  CALL(stratus_tree_get_statistics(NULL, NULL));
  CALL(stratus_tree_boxes(NULL, NULL));
  (void)CALL(stratus_tree_bytes(NULL));
  (void)CALL(stratus_tree_hash(NULL));
  CALL(stratus_tree_save(NULL, NULL));
  EXPECT(CALL(stratus_octree_count(NULL)) == 0 && CALL(stratus_octree_id_limit(NULL)) == 0, "an octree of nothing");
  CALL(stratus_octree_clear(NULL));
  stratus_octree_statistics s;
  CALL(stratus_octree_get_statistics(NULL, &s));
  CALL(stratus_octree_get_statistics(NULL, NULL));
  stratus_partition_result r;
  CALL(stratus_partition_get(NULL, &r));
  CALL(stratus_partition_get(NULL, NULL));
  CALL(stratus_ray_caster_release(NULL));
  CALL(stratus_tetra_caster_release(NULL));
  EXPECT(
    CALL(stratus_octree_check(NULL)) == bad && CALL(stratus_octree_query_box(NULL, NULL, NULL, 0, NULL)) == bad, "an octree of nothing");
  EXPECT(CALL(stratus_octree_insert(NULL, NULL, 1, NULL)) == bad && CALL(stratus_octree_cull(NULL, NULL, NULL, NULL)) == bad, "no octree");
  EXPECT(CALL(stratus_visibility_order_sort(NULL, NULL, NULL, STRATUS_PEELING_NEAREST, NULL)) == bad, "an order of nothing");
  EXPECT(CALL(stratus_ray_caster_render(NULL, NULL, NULL, NULL, NULL, NULL, NULL)) == bad, "a picture of nothing");
  EXPECT(CALL(stratus_tetra_caster_render(NULL, NULL, NULL, NULL, NULL, NULL, NULL)) == bad, "a picture of nothing");
  EXPECT(
    STATUS(stratus_tree_check(f->context, NULL, NULL)) == bad && STATUS(stratus_tree_load(f->context, NULL, 8, NULL)) == bad, "no tree");
  EXPECT(CALL(stratus_frustum_side(NULL, NULL, 1)) <= STRATUS_SIDE_INSIDE, "a side of nothing");
  (void)CALL(stratus_context_on_device(NULL));
  stratus_program_statistics programs;
  CALL(stratus_context_get_programs(NULL, &programs));
  EXPECT(programs.built == 0 && programs.loaded == 0, "programs of nothing");
  EXPECT(
    CALL(stratus_context_threads(NULL)) == 0 && CALL(stratus_context_message(NULL)) && CALL(stratus_context_device(NULL)), "no context");
}

static void make_context(fuzz* f)
{
  static const char* const devices[] = { "host", "host", "host", "", "no such device", "-1", "99999999999999999999", "2147483648", "h",
    "%s%n" };
  static const char* const folders[] = { "", "", "/no/such/folder", "%s%n", "/dev/null/below" };
  static char longest[4000];
  fuzz_memory memory;
  stratus_program_statistics programs;
  stratus_context_options o = fuzz_context_options(f, &memory);
  const char* device = devices[fuzz_below(f, sizeof devices / sizeof *devices)];
  o.device = fuzz_input(f, device, strlen(device) + 1);
  const size_t folder = fuzz_below(f, 2 + sizeof folders / sizeof *folders), length = fuzz_below(f, sizeof longest);
  memset(longest, 'x', sizeof longest);
  longest[length] = '\0';
  if (folder < sizeof folders / sizeof *folders) {
    o.program_folder = fuzz_input(f, folders[folder], strlen(folders[folder]) + 1);
  } else {
    o.program_folder = folder % 2 ? NULL : fuzz_input(f, longest, length + 1);
  }
  o.threads = fuzz_odd(f) ? (int)(uint32_t)(uint64_t)fuzz_odd_integer(f) : fuzz_integer(f, 0, 1024);
  o.allocate = fuzz_odd(f) ? NULL : o.allocate;
  o.release = fuzz_odd(f) ? NULL : o.release;
  memory.fail_at = fuzz_chance(f, 0.1) ? 1 + (int64_t)fuzz_below(f, 3) : 0;
  const size_t capacity = fuzz_chance(f, 0.3) ? fuzz_below(f, 8) : 200;
  char* message = fuzz_output(f, capacity);
  stratus_context *context = NULL, **out = fuzz_odd(f) ? NULL : &context;
  const stratus_status status = CALL(stratus_context_create(FUZZ_INPUT(f, o), out, message, capacity));
  ++f->tally->statuses[status];
  if (status == STRATUS_OK) {
    EXPECT(context && CALL(stratus_context_threads(context)) >= 1 && strlen(CALL(stratus_context_device(context))) > 0, "no context");
    EXPECT(strcmp(CALL(stratus_context_message(context)), "") == 0, "a message before any failure");
    (void)CALL(stratus_context_on_device(context));
    CALL(stratus_context_get_programs(context, fuzz_odd(f) ? NULL : &programs));
  } else {
    EXPECT(!context, "%s, but a context", stratus_status_name(status));
    EXPECT(capacity == 0 || !out || memchr(message, '\0', capacity), "the message does not end");
    EXPECT(capacity < 2 || !out || message[0], "%s without a message", stratus_status_name(status));
  }
  CALL(stratus_context_destroy(context));
  EXPECT(memory.live == 0, "%lld allocations are left", (long long)memory.live);
}

static void check_frustum(fuzz* f, const stratus_camera* camera)
{
  stratus_frustum* frustum = fuzz_output(f, sizeof *frustum);
  double bounds[6];
  const stratus_status status = STATUS(stratus_frustum_from_camera(f->context, fuzz_pointer(f, FUZZ_INPUT(f, *camera)), frustum));
  if (status != STRATUS_OK) {
    EXPECT(!fuzz_is_tame(f), "%s", stratus_context_message(f->context));
    memset(frustum, 0x7b, sizeof *frustum);
  }
  for (int i = 0; i < 24; ++i) {
    frustum->planes[i / 4][i % 4] = fuzz_odd(f) ? fuzz_odd_real(f) : frustum->planes[i / 4][i % 4];
  }
  const stratus_frustum* given = FUZZ_INPUT(f, *frustum);
  (void)STATUS(stratus_frustum_check(f->context, given));
  for (int times = 0; times < 8; ++times) {
    for (int axis = 0; axis < 3; ++axis) {
      bounds[2 * axis] = fuzz_real(f, -20.0, 20.0);
      bounds[2 * axis + 1] = fuzz_odd(f) ? fuzz_odd_real(f) : bounds[2 * axis] + fuzz_between(f, 0.0, 10.0);
    }
    const double* box = FUZZ_INPUT(f, bounds);
    const stratus_side side = CALL(stratus_frustum_side(given, box, 0)), exact = CALL(stratus_frustum_side(given, box, 1));
    EXPECT((unsigned)side <= STRATUS_SIDE_INSIDE && (unsigned)exact <= STRATUS_SIDE_INSIDE, "side %d, %d", (int)side, (int)exact);
    EXPECT(side != STRATUS_SIDE_OUTSIDE || exact == STRATUS_SIDE_OUTSIDE, "outside, but exactly %d", (int)exact);
    EXPECT(exact != STRATUS_SIDE_OUTSIDE || side != STRATUS_SIDE_INSIDE, "inside, but exactly outside");
  }
}

static void check_camera(fuzz* f)
{
  double eye[3], focal[3], up[3], bounds[6];
  stratus_camera camera;
  fuzz_vector(f, -10.0, 10.0, eye);
  fuzz_vector(f, -10.0, 10.0, focal);
  fuzz_vector(f, -1.0, 1.0, up);
  const double angle = fuzz_real(f, 0.1, 179.0), aspect = fuzz_real(f, 0.1, 10.0), scale = fuzz_real(f, 0.1, 10.0);
  const double *from = fuzz_pointer(f, FUZZ_INPUT(f, eye)), *to = fuzz_pointer(f, FUZZ_INPUT(f, focal)),
               *above = fuzz_pointer(f, FUZZ_INPUT(f, up));
  stratus_camera* out = fuzz_odd(f) ? NULL : fuzz_output(f, sizeof *out);
  const bool parallel = fuzz_chance(f, 0.5);
  memset(&camera, 0x7b, sizeof camera);
  const stratus_status status = STATUS(parallel ? stratus_camera_parallel(f->context, from, to, above, scale, aspect, out)
                                                : stratus_camera_perspective(f->context, from, to, above, angle, aspect, out));
  EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  EXPECT(status == STRATUS_OK || !out || memcmp(out, &camera, sizeof camera) == 0, "refused, but the camera was written");
  if (status == STRATUS_OK) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT(isfinite(out->forward[axis]) && isfinite(out->right[axis]) && isfinite(out->up[axis]), "a camera of no numbers");
    }
    check_frustum(f, out);
  }
  for (int axis = 0; axis < 3; ++axis) {
    bounds[2 * axis] = fuzz_real(f, -20.0, 20.0);
    bounds[2 * axis + 1] = fuzz_odd(f) ? fuzz_odd_real(f) : bounds[2 * axis] + fuzz_between(f, 0.1, 10.0);
  }
  const double* box = fuzz_pointer(f, FUZZ_INPUT(f, bounds));
  const int axis = fuzz_integer(f, 0, 2), view = fuzz_integer(f, 0, 7), flag = fuzz_flag(f);
  const stratus_status seen = STATUS(stratus_scene_camera(f->context, box, axis, view, flag, aspect, fuzz_odd(f) ? NULL : &camera));
  EXPECT(seen == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
}

/* Requests scenes by unknown names or NULL. */
static void ask_records(fuzz* f)
{
  static const char* const names[] = { "", "clouds", "cloud ", "%n", "u", "0" };
  const char* name = names[fuzz_below(f, sizeof names / sizeof *names)];
  const char* given = fuzz_pointer(f, fuzz_input(f, name, strlen(name) + 1));
  double point[3];
  stratus_scene* scene = NULL;
  stratus_mesh_scene* mesh = NULL;
  int64_t n[3];
  int32_t* positions = NULL;
  size_t count = 0;
  fuzz_vector(f, -2.0, 2.0, point);
  EXPECT(CREATE(&scene, stratus_scene_create(f->context, given, &scene)) == STRATUS_INVALID_ARGUMENT, "a scene of no name");
  EXPECT(CREATE(&mesh, stratus_mesh_scene_create(f->context, given, &mesh)) == STRATUS_INVALID_ARGUMENT, "a mesh of no name");
  EXPECT(CREATE(&positions, stratus_voxel_scene_create(f->context, given, n, &positions, &count)) == STRATUS_INVALID_ARGUMENT,
    "voxels of no name");
  EXPECT(isnan(CALL(stratus_mesh_scene_value(given, point))), "a value of no scene");
  EXPECT(isfinite(CALL(stratus_mesh_scene_value("wavelet", FUZZ_INPUT(f, point)))) || !fuzz_is_tame(f), "no value of a scene");
  CALL(stratus_scene_destroy(f->context, NULL));
  CALL(stratus_mesh_scene_destroy(f->context, NULL));
  CALL(stratus_voxel_scene_release(f->context, NULL));
}

/* Creates scenes of record, but seldom, since they take seconds. */
static void make_records(fuzz* f)
{
  stratus_voxels* voxels = NULL;
  stratus_mesh_scene* mesh = NULL;
  int64_t n[3];
  int32_t* positions = NULL;
  size_t count = 0;
  EXPECT(CREATE(&positions, stratus_voxel_scene_create(f->context, "17K", n, &positions, &count)) == STRATUS_OK, "no voxels of record");
  const stratus_status listed = CREATE(&voxels, stratus_voxels_create_list(f->context, n, positions, count, &voxels));
  EXPECT(listed == STRATUS_OK && CALL(stratus_voxels_count(voxels)) <= (int64_t)count, "voxels of record are no list");
  stratus_ray* rays = fuzz_output(f, (size_t)512 * 512 * sizeof *rays);
  EXPECT(STATUS(stratus_voxel_scene_rays(f->context, voxels, (int)fuzz_below(f, 2), rays)) == STRATUS_OK, "no rays of record");
  EXPECT(
    STATUS(stratus_voxel_scene_rays(f->context, voxels, 2 + (int)fuzz_below(f, 9), rays)) == STRATUS_INVALID_ARGUMENT, "rays of no kind");
  EXPECT(CREATE(&mesh, stratus_mesh_scene_create(f->context, "holes", &mesh)) == STRATUS_OK, "no mesh of record");
  CALL(stratus_mesh_scene_destroy(f->context, mesh));
  CALL(stratus_voxel_scene_release(f->context, positions));
  CALL(stratus_voxels_destroy(voxels));
}

static void check_views(fuzz* f)
{
  const fuzz_field field = fuzz_volume(f, 5, 1);
  double *bounds = fuzz_output(f, 6 * sizeof(double)), before[6];
  memcpy(before, bounds, sizeof before);
  const stratus_status status = STATUS(stratus_volume_bounds(f->context, fuzz_pointer(f, FUZZ_INPUT(f, field.view)), bounds));
  EXPECT(status == STRATUS_OK || memcmp(bounds, before, sizeof before) == 0, "refused, but bounds were written");
  for (int axis = 0; status == STRATUS_OK && axis < 3; ++axis) {
    EXPECT(bounds[2 * axis] <= bounds[2 * axis + 1], "bounds %g..%g", bounds[2 * axis], bounds[2 * axis + 1]);
  }
  (void)STATUS(stratus_volume_check(f->context, fuzz_pointer(f, FUZZ_INPUT(f, field.view))));
  const fuzz_tetrahedra t = fuzz_mesh(f, 2);
  (void)STATUS(stratus_mesh_check(f->context, fuzz_pointer(f, FUZZ_INPUT(f, t.view))));
  const stratus_transfer transfer = fuzz_transfer(f, 0.0, 1.0, 1.0);
  (void)STATUS(stratus_transfer_check(f->context, fuzz_pointer(f, FUZZ_INPUT(f, transfer))));
  EXPECT(CALL(stratus_transfer_check(NULL, NULL)) == STRATUS_INVALID_ARGUMENT, "no context, no transfer function");
  EXPECT(CALL(stratus_volume_check(NULL, &field.view)) == STRATUS_INVALID_ARGUMENT, "no context");
  EXPECT(CALL(stratus_mesh_check(NULL, &t.view)) == STRATUS_INVALID_ARGUMENT, "no context");
}

void fuzz_contexts(fuzz* f)
{
  ask_names(f);
  ask_nothing(f);
  if (fuzz_chance(f, 0.1)) {
    ask_devices(f);
  }
  make_context(f);
  check_camera(f);
  ask_records(f);
  check_views(f);
  if (f->number % 20000 == 0) {
    make_records(f);
  }
}
