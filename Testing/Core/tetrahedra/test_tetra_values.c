/* SPDX-License-Identifier: BSD-3-Clause
 * Values that change on a fixed mesh, as in the steps of a simulation: neighbours and the order of cells stay while points and cells have
 * equal content, in any memory, and the pictures equal those from a new caster. */
#define CASE_FULL_SIZE
#include "tetra_case.h"

#include "faulty_allocator.h"
#include "tetra_caster.h"

static tetra_picture kept, fresh;

typedef struct steps {
  stratus_context* context;
  stratus_tetra_caster* caster;
  tetra_case c;
} steps;

static void begin(steps* s, stratus_context* context, stratus_tetra_method method, int cell_values)
{
  s->context = context;
  tetra_method = method;
  tetra_create(&s->c, 4, 0.2, 0.2, 6);
  s->c.mesh.cell_values = cell_values;
  tetra_camera(context, &s->c, 4, 2, 0);
  assert_int_equal(stratus_tetra_caster_create(context, &s->caster), STRATUS_OK);
}

/* Draws by the caster that has drawn before and by a new one. */
static void step(steps* s)
{
  const stratus_image image = {
    .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = kept.rgba, .depth = kept.depth, .rgba8 = kept.rgba8, .samples = kept.samples
  };
  ++s->c.mesh.revision;
  const stratus_status status =
    stratus_tetra_caster_render(s->caster, &s->c.mesh, &s->c.transfer, &s->c.camera, &s->c.options, &image, &kept.report);
  if (status != STRATUS_OK) {
    print_error("%s\n", stratus_context_message(s->context));
  }
  assert_int_equal(status, STRATUS_OK);
  tetra_draw(s->context, &s->c, &fresh);
  assert_memory_equal(kept.rgba, fresh.rgba, sizeof kept.rgba);
  assert_memory_equal(kept.depth, fresh.depth, sizeof kept.depth);
  assert_memory_equal(kept.samples, fresh.samples, sizeof kept.samples);
  assert_int_equal(kept.report.shown_cells, fresh.report.shown_cells);
  assert_int_equal(kept.report.blanked, fresh.report.blanked);
}

static void built(const steps* s, uint64_t meshes, uint64_t values, uint64_t tables)
{
  assert_int_equal(kept.report.mesh_builds, meshes);
  assert_int_equal(kept.report.value_builds, values);
  assert_int_equal(kept.report.table_builds, tables);
  assert_true(s->caster->value_builds == values);
}

static void* moved(void* old, size_t bytes)
{
  void* new = malloc(bytes);
  assert_non_null(new);
  memcpy(new, old, bytes);
  memset(old, 0x5a, bytes);
  free(old);
  return new;
}

/* A step as readers make it: all arrays in other memory. */
static void move_arrays(tetra_case* c)
{
  const size_t points = (size_t)c->mesh.point_count, cells = (size_t)c->mesh.cell_count;
  c->mesh.points = c->points = moved(c->points, points * 3 * sizeof *c->points);
  c->mesh.vertices = c->vertices = moved(c->vertices, cells * 4 * sizeof *c->vertices);
  c->mesh.values = c->values = moved(c->values, (c->mesh.cell_values ? cells : points) * sizeof *c->values);
}

static void geometry_survives_other_values(void** state)
{
  for (int variant = 0; variant < 4; ++variant) {
    const stratus_tetra_method method = variant & 1 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
    steps s = { .caster = NULL };
    begin(&s, *state, method, variant / 2);
    step(&s);
    built(&s, 1, 1, 1);
    const int32_t* cells = s.caster->mesh->cells;
    const stratus_visibility_order* order = s.caster->projector ? s.caster->projector->order : NULL;
    assert_true((order != NULL) == (method == STRATUS_TETRA_METHOD_PROJECT));
    const float middle = s.c.values[7];
    s.c.values[7] = 0.5f * (s.c.values[7] + s.c.values[8]); /* within the range: the table stays, too */
    step(&s);
    built(&s, 1, 2, 1);
    move_arrays(&s.c);
    s.c.values[7] = middle;
    step(&s);
    built(&s, 1, 3, 1);
    s.c.values[9] = 1.5f; /* beyond it: the table spans other values */
    step(&s);
    built(&s, 1, 4, 2);
    assert_ptr_equal(s.caster->mesh->cells, cells);
    assert_true(!order || s.caster->projector->order == order);
    stratus_tetra_caster_destroy(s.caster);
    tetra_destroy(&s.c);
  }
}

/* Points and cells with the caller's number are not read again: here they would not be the same. Another number has them read. */
static void numbered_geometry_is_not_compared(void** state)
{
  for (int variant = 0; variant < 2; ++variant) {
    steps s = { .caster = NULL };
    begin(&s, *state, STRATUS_TETRA_METHOD_MARCH, variant);
    s.c.mesh.geometry = 5;
    step(&s);
    const int32_t corner = s.c.vertices[0];
    const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = kept.rgba };
    s.c.vertices[0] = s.c.vertices[1];
    s.c.vertices[1] = corner;
    s.c.values[9] = 1.5f;
    for (uint64_t number = 5; number < 7; ++number) {
      ++s.c.mesh.revision;
      s.c.mesh.geometry = number;
      assert_int_equal(
        stratus_tetra_caster_render(s.caster, &s.c.mesh, &s.c.transfer, &s.c.camera, &s.c.options, &image, &kept.report), STRATUS_OK);
      assert_int_equal(kept.report.mesh_builds, number - 4);
    }
    move_arrays(&s.c);
    s.c.mesh.geometry = 7; /* read, found to be the same, and known from then on */
    step(&s);
    built(&s, 2, 4, 3);
    stratus_tetra_caster_destroy(s.caster);
    tetra_destroy(&s.c);
  }
}

/* Points and faces of the frame before are used again only if mesh, camera and image are the same. */
static void frames_differ_by_mesh_camera_and_image(void** state)
{
  for (int variant = 0; variant < 4; ++variant) {
    steps s = { .caster = NULL };
    begin(&s, *state, variant & 1 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH, variant / 2);
    step(&s);
    const stratus_tetra_buffers* buffers = &s.caster->buffers;
    float* const first = buffers->places.memory;
    first[0] += 1.0f; /* a picture with this point is wrong: it shows that it was used again */
    const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = kept.rgba };
    ++s.c.mesh.revision;
    const float moved_to = first[0];
    assert_int_equal(stratus_tetra_caster_render(s.caster, &s.c.mesh, &s.c.transfer, &s.c.camera, &s.c.options, &image, NULL), STRATUS_OK);
    assert_true(first[0] == moved_to);
    s.caster->buffers.placed = s.caster->buffers.binned = false;
    step(&s);
    assert_true(first[0] != moved_to);
    for (int turn = 0; turn < 3; ++turn) { /* there and back */
      tetra_camera(*state, &s.c, 4, turn & 1 ? 2 : 1, 0);
      step(&s);
      s.c.values[7] += 0.01f;
      step(&s);
    }
    stratus_image narrow = { .width = TETRA_WIDTH / 2, .height = TETRA_HEIGHT, .rgba = kept.rgba };
    assert_int_equal(stratus_tetra_caster_render(s.caster, &s.c.mesh, &s.c.transfer, &s.c.camera, &s.c.options, &narrow, NULL), STRATUS_OK);
    step(&s);
    s.c.mesh.matrix[3] += 0.1;
    step(&s);
    s.c.points[3 * 62] += 0.01;
    step(&s);
    stratus_tetra_caster_destroy(s.caster);
    tetra_destroy(&s.c);
  }
}

/* Changes of the visible cells' borders, or of the geometry, rebuild the mesh. */
static void other_geometry_is_built(void** state)
{
  for (int variant = 0; variant < 2; ++variant) {
    steps s = { .caster = NULL };
    begin(&s, *state, variant & 1 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH, 0);
    step(&s);
    const float value = s.c.values[31];
    s.c.values[31] = NAN; /* the cells at this point are hidden */
    step(&s);
    built(&s, 2, 2, 2);
    assert_true(kept.report.blanked > 0);
    s.c.values[31] = value;
    step(&s);
    built(&s, 3, 3, 3);
    s.c.mesh.hidden = s.c.hidden; /* hides none */
    step(&s);
    built(&s, 3, 4, 3);
    s.c.hidden[12] = 1;
    step(&s);
    built(&s, 4, 5, 4);
    s.c.points[3 * 62] += 0.01;
    step(&s);
    built(&s, 5, 6, 5);
    const int32_t corner = s.c.vertices[0];
    s.c.vertices[0] = s.c.vertices[1];
    s.c.vertices[1] = corner;
    step(&s);
    built(&s, 6, 7, 6);
    --s.c.mesh.cell_count;
    step(&s);
    built(&s, 7, 8, 7);
    s.c.mesh.cell_values = 1;
    step(&s);
    built(&s, 8, 9, 8);
    stratus_tetra_caster_destroy(s.caster);
    tetra_destroy(&s.c);
  }
}

/* Leaves of other content at the same address make another order; the same content elsewhere does not. */
static void leaves_are_compared_by_content(void** state)
{
  steps s = { .caster = NULL };
  stratus_partition* partition = NULL;
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition_result cut;
  begin(&s, *state, STRATUS_TETRA_METHOD_PROJECT, 0);
  tetra_destroy(&s.c);
  tetra_create(&s.c, 4, 0.0, 0.0, 5); /* planes of its own cut no cell */
  tetra_camera(*state, &s.c, 4, 2, 0);
  options.leaf_cells = 64;
  assert_int_equal(stratus_partition_create(*state, &s.c.mesh, &options, &partition), STRATUS_OK);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.cell_count, s.c.mesh.cell_count);
  memcpy(s.c.vertices, cut.vertices, (size_t)(4 * cut.cell_count) * sizeof *cut.vertices);
  const size_t nodes = (size_t)cut.leaves.node_count * sizeof *cut.leaves.nodes, cells = (size_t)cut.cell_count * sizeof(int32_t);
  stratus_leaves leaves = cut.leaves;
  stratus_partition_node* own = malloc(nodes);
  int32_t* leaf = malloc(cells);
  assert_true(own && leaf);
  memcpy(own, cut.leaves.nodes, nodes);
  memcpy(leaf, cut.leaves.leaf, cells);
  leaves.nodes = own;
  leaves.leaf = leaf;
  s.c.options.leaves = &leaves;
  step(&s);
  const stratus_visibility_order* order = s.caster->projector->order;
  leaves.leaf = leaf = moved(leaf, cells);
  leaves.nodes = own = moved(own, nodes);
  s.c.values[7] = 0.4f;
  step(&s);
  built(&s, 1, 2, 1);
  assert_ptr_equal(s.caster->projector->order, order);
  leaf[5] = leaf[5] ? 0 : 1; /* a cell in a wrong leaf is refused, which shows that the leaves were read again */
  ++s.c.mesh.revision;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = kept.rgba };
  assert_int_equal(
    stratus_tetra_caster_render(s.caster, &s.c.mesh, &s.c.transfer, &s.c.camera, &s.c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  leaf[5] = cut.leaves.leaf[5];
  step(&s);
  free(own);
  free(leaf);
  stratus_partition_destroy(partition);
  stratus_tetra_caster_destroy(s.caster);
  tetra_destroy(&s.c);
}

/* Memory refused at any allocation of a step is an error, and the same caster draws the step when asked again. */
static void memory_refused_in_a_step(void** state)
{
  (void)state;
  for (int variant = 0; variant < 4; ++variant) {
    faulty_allocator allocator = { 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* context = NULL;
    steps s = { .caster = NULL };
    int refused = 0;
    assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
    begin(&s, context, variant & 1 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH, variant / 2);
    step(&s);
    const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = kept.rgba };
    for (bool reached = true; reached;) {
      s.c.values[7] += 0.01f * (refused & 1 ? -1.0f : 1.0f);
      s.c.values[9] = 1.5f + 0.01f * (float)refused; /* the last value that the table spans */
      ++s.c.mesh.revision;
      allocator.fail_at = allocator.calls + refused + 1;
      const stratus_status status =
        stratus_tetra_caster_render(s.caster, &s.c.mesh, &s.c.transfer, &s.c.camera, &s.c.options, &image, NULL);
      reached = allocator.calls >= allocator.fail_at;
      allocator.fail_at = 0;
      assert_int_equal(status, reached ? STRATUS_OUT_OF_MEMORY : STRATUS_OK);
      refused += reached;
      step(&s);
    }
    assert_true(refused > 3);
    assert_int_equal(kept.report.mesh_builds, 1);
    stratus_tetra_caster_destroy(s.caster);
    tetra_destroy(&s.c);
    stratus_context_destroy(context);
    assert_int_equal(allocator.live, 0);
  }
}

int test_tetra_values(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(geometry_survives_other_values),
    cmocka_unit_test(numbered_geometry_is_not_compared),
    cmocka_unit_test(frames_differ_by_mesh_camera_and_image),
    cmocka_unit_test(other_geometry_is_built),
    cmocka_unit_test(leaves_are_compared_by_content),
    cmocka_unit_test(memory_refused_in_a_step),
  };
  return cmocka_run_group_tests(tests, tetra_start, tetra_stop);
}
