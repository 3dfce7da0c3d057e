/* SPDX-License-Identifier: BSD-3-Clause
 * Values of several components in tetrahedra against a reference in double precision, which intersects rays with cells once for each
 * component and integrates in many steps: independent and dependent ones, of points and of cells, lists and lattices. */
#include "tetra_case.h"

#include "tetra_caster.h"

#define COMPONENTS 4
#define STEPS 200

typedef struct several {
  tetra_case whole;            /* what is drawn: all components */
  tetra_case part[COMPONENTS]; /* each component alone, for the reference */
  float* values[COMPONENTS];
  void* all;
  stratus_transfer transfers[COMPONENTS];
  double opacity[COMPONENTS][6];
  int count;
} several;

static tetra_picture picture, other;
static double reference[4 * TETRA_PIXELS];

static void create(several* s, int n, int count, bool bytes, uint32_t seed)
{
  tetra_create(&s->whole, n, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
  stratus_mesh* m = &s->whole.mesh;
  const int64_t values = m->point_count > m->cell_count ? m->point_count : m->cell_count;
  s->count = count;
  s->all = calloc((size_t)(values * count), bytes ? 1 : sizeof(float));
  assert_non_null(s->all);
  for (int c = 0; c < count; ++c) {
    static const double colors[COMPONENTS][8] = { { 0.0, 1.0, 0.2, 0.1, 1.0, 0.9, 0.9, 0.1 }, { 0.0, 0.1, 0.3, 1.0, 1.0, 0.2, 1.0, 0.4 },
      { 0.2, 0.9, 0.1, 0.8, 0.7, 0.3, 0.3, 0.3 }, { 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0 } };
    const double unit = bytes ? 255.0 : 1.0;
    const double opacity[6] = { (0.2 + 0.1 * c) * unit, 0.0, (0.5 + 0.05 * c) * unit, 0.5 - 0.1 * c, unit, 0.3 };
    s->part[c] = s->whole;
    s->values[c] = calloc((size_t)values, sizeof(float));
    assert_non_null(s->values[c]);
    for (int64_t i = 0; i < values; ++i) {
      const double v = 0.5 + 0.45 * sin((1.3 + 0.4 * c) * (double)(i % (n + 1)) + 0.7 * (double)(i / (n + 1)) + seed + 2.0 * c);
      s->values[c][i] = bytes ? (float)(uint8_t)(v * 255.0) : (float)v;
      if (bytes) {
        ((uint8_t*)s->all)[i * count + c] = (uint8_t)(v * 255.0);
      } else {
        ((float*)s->all)[i * count + c] = s->values[c][i];
      }
    }
    s->part[c].values = s->values[c];
    memcpy(s->opacity[c], opacity, sizeof opacity);
    s->transfers[c] = stratus_transfer_default();
    s->transfers[c].opacity = s->opacity[c];
    s->transfers[c].opacity_count = 3;
    s->transfers[c].color = colors[c];
    s->transfers[c].color_count = 2;
    s->transfers[c].weight = c == 1 ? 0.6 : 1.0;
  }
  m->values = s->all;
  m->type = bytes ? STRATUS_UINT8 : STRATUS_FLOAT32;
  m->value_stride = m->components = count;
}

static void destroy(several* s)
{
  for (int c = 0; c < s->count; ++c) {
    free(s->values[c]);
  }
  free(s->all);
  tetra_destroy(&s->whole);
}

static double depth_of(const stratus_transfer* t, double value)
{
  return -log1p(-linear_between(t->opacity, t->opacity_count, 2, 1, value)) / t->unit_distance;
}

static void color_of(const stratus_transfer* t, double value, double rgb[3])
{
  for (size_t k = 0; k < 3; ++k) {
    rgb[k] = linear_between(t->color, t->color_count, 4, k + 1, value);
  }
}

/* Adds one step of a ray: the values of all components there. */
static void add_step(const several* s, const double value[COMPONENTS], double length, double out[4])
{
  const stratus_tetra_options* o = &s->whole.options;
  double depth = 0.0, squares = 0.0, glow[3] = { 0.0, 0.0, 0.0 };
  for (int c = o->dependent ? s->count - 1 : 0; c < s->count; ++c) {
    const stratus_transfer* t = s->transfers + (o->dependent ? 0 : c);
    const double own = depth_of(t, value[c]) * (o->dependent ? 1.0 : t->weight);
    double rgb[3];
    color_of(t, value[o->dependent ? 0 : c], rgb);
    for (int k = 0; k < 3; ++k) {
      glow[k] += own * (o->dependent && s->count == 4 ? value[k] / 255.0 : rgb[k]);
    }
    depth += own;
    squares += own * own;
  }
  depth = o->mean_components && !o->dependent && depth > 0.0 ? squares / depth : depth;
  const double alpha = -expm1(-depth * length);
  for (int k = 0; k < 3 && depth > 0.0; ++k) {
    out[k] += (1.0 - out[3]) * alpha * glow[k] / depth;
  }
  out[3] += (1.0 - out[3]) * alpha;
}

typedef struct met_cell {
  tetra_stretch of[COMPONENTS];
} met_cell;

static int nearer(const void* a, const void* b)
{
  return tetra_nearer(((const met_cell*)a)->of, ((const met_cell*)b)->of);
}

static void draw_reference(const several* s)
{
  const stratus_camera* k = &s->whole.camera;
  met_cell* met = calloc((size_t)s->part[0].mesh.cell_count + 1, sizeof *met);
  assert_non_null(met);
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    const double u = (2.0 * (pixel % TETRA_WIDTH) + 1.0) / TETRA_WIDTH - 1.0, v = (2.0 * (pixel / TETRA_WIDTH) + 1.0) / TETRA_HEIGHT - 1.0;
    double origin[3], along[3], square = 0.0, *out = reference + 4 * pixel;
    size_t count = 0;
    for (int a = 0; a < 3; ++a) {
      const double side = u * k->right[a] + v * k->up[a];
      origin[a] = k->eye[a] + (k->parallel ? side : 0.0);
      along[a] = k->forward[a] + (k->parallel ? 0.0 : side);
      square += along[a] * along[a];
    }
    for (int64_t cell = 0; cell < s->part[0].mesh.cell_count; ++cell) {
      int meets = 1;
      for (int c = 0; c < s->count; ++c) {
        meets = meets && tetra_meet(s->part + c, cell, origin, along, k->near_k, k->far_k, &met[count].of[c]);
      }
      count += (size_t)meets;
    }
    qsort(met, count, sizeof *met, nearer);
    memset(out, 0, 4 * sizeof *out);
    for (size_t i = 0; i < count; ++i) {
      const double length = (met[i].of[0].to - met[i].of[0].from) * sqrt(square) / STEPS;
      for (int step = 0; step < STEPS; ++step) {
        double value[COMPONENTS] = { 0.0 };
        for (int c = 0; c < s->count; ++c) {
          value[c] = met[i].of[c].first + (step + 0.5) / STEPS * (met[i].of[c].last - met[i].of[c].first);
        }
        add_step(s, value, length, out);
      }
    }
  }
  free(met);
}

static void draw(stratus_context* context, const several* s, tetra_picture* p)
{
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = p->rgba, .depth = p->depth };
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  const stratus_status status =
    stratus_tetra_caster_render(caster, &s->whole.mesh, s->transfers, &s->whole.camera, &s->whole.options, &image, &p->report);
  if (status != STRATUS_OK) {
    print_error("%s\n", stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
  stratus_tetra_caster_destroy(caster);
}

/* The default tolerance is a quarter of a step of 255. */
static void components_are_right(void** state)
{
  for (uint32_t seed = 0; seed < 12; ++seed) {
    several s;
    const int kind = (int)(seed % 4); /* independent, their mean, 2 and 4 dependent */
    create(&s, 3, kind == 3 ? 4 : kind == 2 ? 2 : 2 + (int)(seed / 4), kind == 3, seed);
    s.whole.options.mean_components = kind == 1;
    s.whole.options.dependent = kind > 1;
    s.whole.mesh.cell_values = seed / 4 == 1;
    for (int c = 0; c < s.count; ++c) {
      s.part[c].mesh.cell_values = s.whole.mesh.cell_values;
    }
    tetra_camera(*state, &s.whole, 3, (int)(seed % 8), seed & 1);
    draw_reference(&s);
    draw(*state, &s, &picture);
    double largest;
    const double error = tetra_error(picture.rgba, reference, &largest);
    if (!(error < 0.255)) {
      print_error("seed %u, %d components: %.3f of 255, at most %.2f\n", seed, s.count, error, largest);
    }
    assert_true(error < 0.255);
    assert_string_equal(picture.report.why, "march as asked");
    destroy(&s);
  }
}

/* Two equal components of half the weight are the component; a component that is not finite hides its cells. */
static void halves_are_a_whole(void** state)
{
  several s, one;
  create(&s, 4, 2, false, 1);
  create(&one, 4, 2, false, 1);
  for (int64_t i = 0; i < s.whole.mesh.point_count; ++i) {
    ((float*)s.all)[2 * i + 1] = ((float*)s.all)[2 * i];
  }
  s.transfers[1] = s.transfers[0];
  s.transfers[0].weight = s.transfers[1].weight = 0.5;
  one.whole.mesh.components = 1;
  tetra_camera(*state, &s.whole, 4, 3, 0);
  one.whole.camera = s.whole.camera;
  draw(*state, &s, &picture);
  draw(*state, &one, &other);
  for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
    assert_true(fabs((double)(picture.rgba[i] - other.rgba[i])) < 1e-3);
  }
  ((float*)s.all)[2 * 62 + 1] = NAN;
  draw(*state, &s, &picture);
  assert_true(picture.report.blanked > 0);
  destroy(&s);
  destroy(&one);
}

static void lattices_threads_and_sets_agree(void** state)
{
  stratus_context* context = *state;
  for (uint32_t seed = 1; seed < 5; ++seed) {
    several s;
    create(&s, 4, seed == 4 ? 4 : 2, seed == 4, seed == 3 ? 5 : seed);
    s.whole.options.dependent = seed > 2;
    tetra_camera(context, &s.whole, 4, (int)seed, seed & 1);
    draw(context, &s, &picture);
    const int threads = context->threads, isa = context->isa;
    context->threads = threads + 1;
    for (context->isa = isa - 1; context->isa >= 0; --context->isa) {
      draw(context, &s, &other);
      assert_memory_equal(picture.rgba, other.rgba, sizeof picture.rgba);
      assert_memory_equal(picture.depth, other.depth, sizeof picture.depth);
    }
    context->threads = threads;
    context->isa = isa;
    if (s.whole.mesh.cell_count == 6 * 64) {
      tetra_as_lattice(&s.whole, 4);
      draw(context, &s, &other);
      for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
        assert_true(fabs((double)(picture.rgba[i] - other.rgba[i])) < 1e-4);
      }
    }
    destroy(&s);
  }
}

static void wrong_components_are_refused(void** state)
{
  static const char* const words[] = { "components 5 outside 1..4", "must be at least its 3 components", "not supported in mode maximum",
    "cannot be projected", "dependent components", "light and gradient opacity of 2", "light and gradient opacity of 2" };
  static const double thin[2] = { 0.0, 0.5 };
  stratus_tetra_caster* caster = NULL;
  several s;
  create(&s, 2, 2, false, 1);
  tetra_camera(*state, &s.whole, 2, 1, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int wrong = 0; wrong < 7; ++wrong) {
    stratus_mesh mesh = s.whole.mesh;
    stratus_tetra_options o = s.whole.options;
    stratus_transfer transfers[2] = { s.transfers[0], s.transfers[1] };
    o.method = wrong == 3 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_AUTO;
    o.mode = wrong == 2 ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
    mesh.components = wrong == 0 ? 5 : wrong == 1 || wrong == 4 ? 3 : 2;
    mesh.value_stride = wrong == 4 ? 3 : 2;
    mesh.point_count = wrong == 4 ? 0 : mesh.point_count;
    mesh.cell_count = wrong == 4 ? 0 : mesh.cell_count;
    o.dependent = wrong == 4;
    o.shade = wrong == 5;
    transfers[1].gradient = thin;
    transfers[1].gradient_count = wrong == 6;
    assert_int_equal(stratus_tetra_caster_render(caster, &mesh, transfers, &s.whole.camera, &o, &image, NULL),
      wrong < 2 ? STRATUS_INVALID_ARGUMENT : STRATUS_UNSUPPORTED);
    if (!strstr(stratus_context_message(*state), words[wrong])) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_non_null(strstr(stratus_context_message(*state), words[wrong]));
  }
  stratus_tetra_caster_destroy(caster);
  destroy(&s);
}

int test_tetra_components(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(components_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(halves_are_a_whole, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(lattices_threads_and_sets_agree, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_components_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
