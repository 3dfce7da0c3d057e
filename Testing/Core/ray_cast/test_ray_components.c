/* SPDX-License-Identifier: BSD-3-Clause
 * Gradient opacity and volumes of several components, independent and dependent, compared with the double reference. Also every structure
 * to the bit, each function and weight by its effect, and refusals. */
#include "picture_case.h"

#include "ray_caster.h"
#include "reference_modes.h"
#include "volume.h"

/* dB against the reference at a quarter of a voxel, as for one component: only the sampling's own error is left. */
#define MIDPOINT_DB 64.0
#define COMPONENTS 4

typedef struct many {
  picture_case c; /* geometry, camera and options; its values are of component 0 */
  stratus_transfer transfers[COMPONENTS];
  void* values; /* interleaved */
} many;

static picture drawn;
static picture other;

/* `count` fields of one type at one place. Component i comes from seed + i and has a transfer function in a colour of its own. */
static void many_create(stratus_context* context, many* m, stratus_type type, int count, int64_t nx, int64_t ny, int64_t nz, uint32_t seed)
{
  static const double colors[COMPONENTS][4] = { { 0, 1, 0.2, 0.1 }, { 0, 0.1, 0.9, 0.3 }, { 0, 0.2, 0.3, 1 }, { 0, 0.9, 0.9, 0.1 } };
  const size_t size = stratus_type_size(type), voxels = (size_t)(nx * ny * nz);
  case_create(context, &m->c, type, nx, ny, nz, seed);
  m->values = malloc(voxels * size * (size_t)count);
  assert_non_null(m->values);
  for (int i = 0; i < count; ++i) {
    case_fill(&m->c, seed + 31u * (uint32_t)i);
    for (size_t v = 0; v < voxels; ++v) {
      memcpy((char*)m->values + (v * (size_t)count + (size_t)i) * size, (const char*)m->c.values + v * size, size);
    }
    m->transfers[i] = m->c.transfer;
    m->transfers[i].color = i == 0 ? m->c.transfer.color : colors[i];
    m->transfers[i].color_count = i == 0 ? m->c.transfer.color_count : 1;
    m->transfers[i].unit_distance = 1.0 + 0.5 * i;
  }
  m->c.volume.values = m->values;
  m->c.volume.components = count;
  m->c.volume.value_stride = count;
}

static void many_destroy(many* m)
{
  case_destroy(&m->c);
  free(m->values);
}

static stratus_status draw_status(stratus_context* context, const many* m, picture* p)
{
  stratus_ray_caster* caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth, .samples = p->samples };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  memset(&p->report, 0, sizeof p->report);
  stratus_status status = stratus_ray_caster_render(caster, &m->c.volume, m->transfers, &m->c.camera, &m->c.options, &image, &p->report);
  for (int again = 0; status == STRATUS_OK && again < 2;
       ++again) { /* once rays have read enough, values are kept as floats: the same bits */
    static picture kept;
    const stratus_image next = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = kept.rgba, .depth = kept.depth };
    status = stratus_ray_caster_render(caster, &m->c.volume, m->transfers, &m->c.camera, &m->c.options, &next, NULL);
    assert_memory_equal(kept.rgba, p->rgba, sizeof kept.rgba);
    assert_memory_equal(kept.depth, p->depth, sizeof kept.depth);
  }
  stratus_ray_caster_destroy(caster);
  return status;
}

static void draw(stratus_context* context, const many* m, picture* p)
{
  const stratus_status status = draw_status(context, m, p);
  if (status != STRATUS_OK) {
    print_error("%s\n", stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
}

static void check(const char* what, stratus_context* context, const many* m, double wanted)
{
  static float reference[4 * CASE_PIXELS];
  reference_scene scene = case_scene(&m->c);
  double reference_db = 0.0;
  scene.transfer = m->transfers;
  scene.dependent = m->c.options.dependent;
  scene.mean_components = m->c.options.mean_components;
  scene.gradient_distance = m->c.options.gradient_distance;
  scene.shading = m->c.options.shade || m->c.options.materials ? &m->c.options.shading : NULL;
  scene.materials = m->c.options.materials;
  draw(context, m, &drawn);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 62.0, reference, NULL, &reference_db), 0);
  const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels\n", what, db, reference_db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > 50);
  assert_true(db >= wanted);
}

static void gradient_opacity_thins_as_the_reference_says(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.0, 0.2, 0.4, 0.45, 1.0 };
  stratus_context* context = case_context("host", 2);
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 1, 26, 24, 28, 71);
  draw(context, &m, &other);
  m.transfers[0].gradient = steep;
  m.transfers[0].gradient_count = 3;
  check("midpoint", context, &m, MIDPOINT_DB);
  double before = 0.0, after = 0.0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    before += (double)other.rgba[4 * i + 3];
    after += (double)drawn.rgba[4 * i + 3];
    assert_true(drawn.rgba[4 * i + 3] <= other.rgba[4 * i + 3] + 1e-5f);
  }
  assert_true(after < 0.9 * before && after > 0.02 * before);
  m.c.options.shade = 1;
  m.c.volume.spacing[1] = 1.5; /* magnitudes are per mean spacing */
  case_camera(context, &m.c, 2, 0);
  check("lit, uneven", context, &m, MIDPOINT_DB);
  m.c.options.sampling = STRATUS_SAMPLING_PREINTEGRATED;
  check("pre-integrated", context, &m, MIDPOINT_DB);
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* Opacities that are multiplied show less than depths that are, the less the longer the way; and a way of length 0 is the depth. */
static void gradient_opacity_of_opacities_thins_as_the_reference_says(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.1, 0.2, 0.4, 0.45, 0.9 };
  static const double lengths[] = { 0.001, 0.5, 3.0, 50.0 };
  stratus_context* context = case_context("host", 2);
  for (int opaque = 0; opaque < 2; ++opaque) {
    many m;
    double before = INFINITY;
    many_create(context, &m, STRATUS_FLOAT32, 1, 26, 24, 28, 71);
    m.transfers[0].gradient = steep;
    m.transfers[0].gradient_count = 3;
    if (opaque) { /* the largest values have opacity 1, which depths cannot thin */
      m.c.opacity[5] = m.c.opacity[7] = 1.0;
    }
    draw(context, &m, &other);
    for (int i = 0; i < 4; ++i) {
      char what[64];
      double alpha = 0.0;
      m.c.options.gradient_distance = lengths[i];
      m.c.options.shade = i == 2;
      m.c.options.sample_distance = opaque ? 0.02 : m.c.options.sample_distance; /* opacity 1 begins like a step */
      snprintf(what, sizeof what, "over %g%s%s", lengths[i], opaque ? ", opacity 1" : "", i == 2 ? ", lit" : "");
      check(what, context, &m, opaque ? 58.0 : MIDPOINT_DB);
      for (int pixel = 0; pixel < CASE_PIXELS; ++pixel) {
        alpha += (double)drawn.rgba[4 * pixel + 3];
      }
      assert_true(alpha < before);
      before = alpha;
      if (i == 0 && !opaque) {
        assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > 55.0);
      }
    }
    m.c.options.sampling = STRATUS_SAMPLING_PREINTEGRATED;
    draw(context, &m, &drawn);
    assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_MIDPOINT);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* A white slab of opacity 1 in a field of constant gradient: of gradient opacity F, a way of the length that is set shows F. */
static void a_slab_of_opacity_one_shows_its_gradient_opacity(void** state)
{
  (void)state;
  static const double fifth[] = { 0.0, 0.2, 1.0, 0.2 };
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 8, 8, 5, 3);
  float* values = c.values;
  for (int v = 0; v < 8 * 8 * 5; ++v) {
    values[v] = (float)(v / 64);
  }
  c.opacity[0] = 0.0, c.opacity[2] = 1.0, c.opacity[4] = 2.0, c.opacity[6] = 4.0;
  c.opacity[1] = c.opacity[3] = c.opacity[5] = c.opacity[7] = 1.0;
  c.transfer.gradient = fifth;
  c.transfer.gradient_count = 2;
  c.volume.spacing[0] = c.volume.spacing[1] = c.volume.spacing[2] = 1.0;
  c.camera = (stratus_camera){ .eye = { 3.5, 3.5, -10.0 },
    .forward = { 0.0, 0.0, 1.0 },
    .right = { 5.0, 0.0, 0.0 },
    .up = { 0.0, 5.0, 0.0 },
    .far_k = INFINITY,
    .parallel = 1 };
  c.options.sample_distance = 0.1;
  for (int times = 0; times < 4; ++times) { /* the slab is 4 long */
    const double length = times == 0 ? 0.0 : 4.0 / times, wanted = times == 0 ? 1.0 : 1.0 - pow(0.8, times);
    stratus_ray_caster* caster = NULL;
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
    c.options.gradient_distance = length;
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_OK);
    const double alpha = (double)drawn.rgba[4 * (CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2) + 3];
    print_message("             over %g: %.6f, wanted %.6f\n", length, alpha, wanted);
    assert_true(fabs(alpha - wanted) < 2e-5); /* floats of 40 samples */
    stratus_ray_caster_destroy(caster);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void components_that_count_by_their_share_mix_as_the_reference_mixes_them(void** state)
{
  (void)state;
  static const double steep[] = { 0.0, 0.2, 10.0, 1.0 };
  stratus_context* context = case_context("host", 2);
  for (int count = 2; count <= COMPONENTS; ++count) {
    many m;
    char what[64];
    double sum = 0.0, mean = 0.0;
    many_create(context, &m, count == 3 ? STRATUS_UINT8 : STRATUS_FLOAT32, count, 20, 17, 19, 5u + (uint32_t)(10 * count));
    m.transfers[1].weight = 0.4;
    m.transfers[count - 1].gradient = steep;
    m.transfers[count - 1].gradient_count = count == 3 ? 2 : 0;
    m.c.options.shade = count == 2;
    case_camera(context, &m.c, count, 0);
    draw(context, &m, &other);
    m.c.options.mean_components = 1;
    snprintf(what, sizeof what, "mean of %d%s", count, m.c.options.shade ? ", lit" : "");
    check(what, context, &m, MIDPOINT_DB);
    for (int pixel = 0; pixel < CASE_PIXELS; ++pixel) {
      sum += (double)other.rgba[4 * pixel + 3];
      mean += (double)drawn.rgba[4 * pixel + 3];
    }
    assert_true(mean < 0.97 * sum);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

static void independent_components_mix_as_the_reference_mixes_them(void** state)
{
  (void)state;
  static const double steep[] = { 0.0, 0.2, 10.0, 1.0 };
  static const stratus_type types[] = { STRATUS_UINT8, STRATUS_FLOAT32, STRATUS_INT32, STRATUS_FLOAT64 };
  stratus_context* context = case_context("host", 2);
  for (int count = 2; count <= COMPONENTS; ++count) {
    for (int t = 0; t < 4; ++t) {
      many m;
      char what[64];
      many_create(context, &m, types[t], count, 20, 17, 19, 5u + (uint32_t)(10 * count + t));
      m.transfers[1].weight = 0.4;
      m.transfers[count - 1].gradient = types[t] == STRATUS_UINT8 ? steep : NULL;
      m.transfers[count - 1].gradient_count = types[t] == STRATUS_UINT8 ? 2 : 0;
      m.c.options.shade = t % 2;
      case_camera(context, &m.c, count + t, t == 1);
      snprintf(what, sizeof what, "%d of %s%s", count, case_type_names[types[t]], m.c.options.shade ? ", lit" : "");
      check(what, context, &m, MIDPOINT_DB);
      many_destroy(&m);
    }
  }
  stratus_context_destroy(context);
}

/* The second component and its functions in other units give the same picture, however much smaller or larger its range is than the
 * first's. */
static void each_component_has_its_own_units(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (int power = -50; power <= 63; power += 113) { /* 1e-15 and 1e19, of which products are exact */
    many m;
    double opacity[8], gradient[4] = { 0.0, 0.1, 0.3, 1.0 };
    many_create(context, &m, STRATUS_FLOAT32, 2, 26, 24, 28, 71);
    memcpy(opacity, m.c.opacity, sizeof opacity);
    m.c.options.shade = 1;
    m.transfers[1].opacity = opacity;
    m.transfers[1].gradient = gradient;
    m.transfers[1].gradient_count = 2;
    draw(context, &m, &drawn);
    float* values = m.values;
    for (size_t v = 0; v < 26 * 24 * 28; ++v) {
      values[2 * v + 1] = ldexpf(values[2 * v + 1], power);
    }
    for (int i = 0; i < 4; ++i) {
      opacity[2 * i] = ldexp(opacity[2 * i], power);
    }
    gradient[2] = ldexp(gradient[2], power);
    draw(context, &m, &other);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             2^%d: %.1f dB, %d pixels\n", power, db, case_lit(&other));
    assert_true(case_lit(&drawn) > 200);
    assert_true(db > 100.0);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

static void dependent_components_are_colour_and_opacity(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 2, 22, 20, 18, 17);
  m.c.options.dependent = 1;
  check("2 of float32", context, &m, MIDPOINT_DB);
  m.c.options.shade = 1;
  check("2 of float32, lit", context, &m, MIDPOINT_DB);
  many_destroy(&m);
  many_create(context, &m, STRATUS_UINT8, 4, 22, 20, 18, 18);
  m.c.options.dependent = 1;
  check("4 of uint8", context, &m, MIDPOINT_DB);
  m.c.options.interpolation = STRATUS_INTERPOLATION_NEAREST;
  m.c.options.sample_distance = 0.02;
  check("4 of uint8, nearest", context, &m, MIDPOINT_DB);
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* Sets four labels in blobs, one of them without functions of its own. */
static void set_labels(many* m, uint8_t* labels)
{
  static const double colors[3][4] = { { 0, 1, 0.2, 0.1 }, { 0, 0.1, 0.9, 0.3 }, { 0, 0.2, 0.3, 1 } };
  const int64_t* n = m->c.volume.dimensions;
  for (int64_t v = 0; v < n[0] * n[1] * n[2]; ++v) {
    const int64_t x = v % n[0], y = v / n[0] % n[1], z = v / n[0] / n[1];
    labels[v] = (uint8_t)((x / 7 + y / 5 + z / 6) % 4);
  }
  m->transfers[1] = m->transfers[2] = m->transfers[0];
  m->transfers[1].color = colors[0];
  m->transfers[2].color = colors[1];
  m->transfers[1].color_count = m->transfers[2].color_count = 1;
  m->transfers[2].unit_distance = 0.4;
  m->c.options.mask = labels;
  m->c.options.label_count = 2;
}

static void labels_have_colours_and_opacities_of_their_own(void** state)
{
  (void)state;
  static uint8_t labels[24 * 22 * 26];
  stratus_context* context = case_context("host", 2);
  for (int type = STRATUS_UINT8; type <= STRATUS_FLOAT64; type += 4) { /* uint8, uint32, float64 */
    many m;
    float reference[4 * CASE_PIXELS];
    many_create(context, &m, (stratus_type)type, 1, 24, 22, 26, 60u + (uint32_t)type);
    draw(context, &m, &other);
    set_labels(&m, labels);
    m.c.volume.cell_centered = type == STRATUS_UINT32;
    m.c.options.shade = type == STRATUS_FLOAT64;
    const double scale = case_type_values[type].scale;
    const double thin[2][4] = { { 0.0, 0.3, 0.3 * scale, 1.0 }, { 0.02 * scale, 1.0, 0.2 * scale, 0.1 } };
    for (int l = 0; l < 2; ++l) { /* label 1 has a gradient opacity of its own, and label 2 that of no label, where there is one */
      m.transfers[l].gradient = thin[l];
      m.transfers[l].gradient_count = type == STRATUS_FLOAT64 || (type == STRATUS_UINT32 && l == 1) ? 2 : 0;
    }
    m.c.options.gradient_distance = type == STRATUS_FLOAT64 ? 2.0 : 0.0;
    m.c.options.sample_distance = 0.02; /* labels are steps: what a sample misses there is of first order */
    reference_scene scene = case_scene(&m.c);
    scene.transfer = m.transfers;
    scene.labels = labels;
    scene.label_count = 2;
    scene.gradient_distance = m.c.options.gradient_distance;
    scene.shading = m.c.options.shade ? &m.c.options.shading : NULL;
    draw(context, &m, &drawn);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 1.0 / 64, reference, NULL), 0);
    const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
    print_message("             labels over %s: %.1f dB, %d pixels\n", case_type_names[type], db, case_lit(&drawn));
    assert_true(case_lit(&drawn) > 200);
    assert_true(db >= 60.0);
    for (int s = STRATUS_STRUCTURE_NONE; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      m.c.options.structure = (stratus_structure)s;
      draw(context, &m, &other);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    }
    m.c.options.label_count = 0; /* the same bytes as a mask, then none */
    draw(context, &m, &other);
    assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

static void no_structure_changes_a_bit(void** state)
{
  (void)state;
  static const double steep[] = { 0.0, 0.0, 0.1, 1.0 };
  stratus_context* contexts[2] = { case_context("host", 1), case_context("host", 3) };
  int lit = 0;
  uint64_t skipped = 0;
  contexts[1]->isa = 1;
  for (uint32_t seed = 1; seed <= 16; ++seed) {
    many m;
    const int count = 1 + (int)(seed % 4);
    many_create(contexts[0], &m, seed % 2 ? STRATUS_FLOAT32 : STRATUS_UINT8, count, 8 + seed, 30 - seed, 21, seed);
    const double base = case_type_values[m.c.volume.type].base, scale = case_type_values[m.c.volume.type].scale;
    const double narrow[8] = { base + 0.2 * scale, 0, base + 0.3 * scale, 0.8, base + 0.35 * scale, 0, base + scale, 0 };
    memcpy(m.c.opacity, narrow, sizeof narrow); /* of all components: mostly empty */
    m.transfers[0].gradient = steep;
    m.transfers[0].gradient_count = 2;
    m.c.options.gradient_distance = seed % 5 == 0 ? 1.5 : 0.0;
    m.c.options.mean_components = seed % 6 == 0;
    m.c.options.dependent = seed > 8 && (count == 2 || (count == 4 && m.c.volume.type == STRATUS_UINT8));
    m.c.options.shade = seed % 3 == 0;
    m.c.options.sample_distance = 0.7;
    m.c.options.structure = STRATUS_STRUCTURE_NONE;
    draw(contexts[0], &m, &drawn);
    lit += case_lit(&drawn) > 0;
    for (int s = STRATUS_STRUCTURE_BLOCK; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      m.c.options.structure = (stratus_structure)s;
      draw(contexts[s % 2], &m, &other);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
      assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
      skipped += other.report.skipped;
    }
    many_destroy(&m);
  }
  assert_true(lit > 12 && skipped > 100000);
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

/* One component is lit and shines, one is lit without a shine, and one is not. */
static void each_component_has_a_material_of_its_own(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_material materials[COMPONENTS] = { { 1, 0.1, 0.5, 0.6, 9.0 }, { 0, NAN, NAN, NAN, NAN }, { 1, 0.3, 0.9, 0.0, 1.0 } };
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 3, 20, 17, 19, 55);
  m.c.options.materials = materials;
  check("three materials", context, &m, MIDPOINT_DB);
  draw(context, &m, &other);
  m.c.options.shade = 1; /* says nothing where there are materials */
  draw(context, &m, &drawn);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  for (int c = 0; c < COMPONENTS; ++c) { /* all alike is as without */
    const stratus_shading* s = &m.c.options.shading;
    materials[c] = (stratus_material){ 1, s->ambient, s->diffuse, s->specular, s->specular_power };
  }
  draw(context, &m, &drawn);
  assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  m.c.options.materials = NULL;
  draw(context, &m, &other);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  m.c.options.shade = 0;
  m.c.options.materials = materials;
  materials[2].diffuse = -0.5;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "-0.5"));
  materials[2].diffuse = 0.5;
  m.c.options.shading.light_count = 9;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  materials[0].shade = materials[1].shade = materials[2].shade = 0; /* no light is read */
  draw(context, &m, &drawn);
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* In modes that find one value a ray: pictures of the reference, one for each component, added in double precision. */
static void one_value_a_ray_is_found_in_each_component(void** state)
{
  (void)state;
  static const stratus_mode modes[] = { STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE };
  static float part[4 * CASE_PIXELS], part_depth[CASE_PIXELS], sum[4 * CASE_PIXELS], depth[CASE_PIXELS];
  stratus_context* context = case_context("host", 2);
  for (int m = 0; m < 4; ++m) {
    many many;
    const int count = 2 + m % 3;
    many_create(context, &many, m == 1 ? STRATUS_UINT8 : STRATUS_FLOAT32, count, 20, 17, 19, 15u + (uint32_t)m);
    many.c.options.mode = modes[m];
    many.c.options.sample_distance = 0.1;
    memset(sum, 0, sizeof sum);
    for (int i = 0; i < CASE_PIXELS; ++i) {
      depth[i] = INFINITY;
    }
    for (int c = 0; c < count; ++c) {
      const stratus_volume view = stratus_volume_component(&many.c.volume, c);
      many.transfers[c].weight = 0.7 - 0.2 * c;
      reference_modes_render(&view, many.transfers + c, &many.c.camera, &many.c.options, CASE_WIDTH, CASE_HEIGHT, 0.02, part, part_depth);
      for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
        const float shown = (float)many.transfers[c].weight * part[i];
        sum[i] = m > 1 && i % 4 == 3 ? fmaxf(sum[i], part[i]) : fminf(sum[i] + shown, 1.0f);
        depth[i / 4] = fminf(depth[i / 4], part_depth[i / 4]);
      }
    }
    draw(context, &many, &drawn);
    const double db = reference_psnr(drawn.rgba, sum, CASE_PIXELS);
    print_message("             %s of %d: %.1f dB, %d pixels\n", stratus_mode_name(modes[m]), count, db, case_lit(&drawn));
    assert_true(case_lit(&drawn) > 200);
    assert_true(db >= 60.0);
    int grazes = 0; /* rays that touch what counts in a point, which samples meet or miss; measured: 1 */
    for (int i = 0; m > 1 && i < CASE_PIXELS; ++i) {
      grazes += isinf(depth[i]) != isinf(drawn.depth[i]);
    }
    assert_in_range(grazes, 0, 2);
    assert_true(drawn.report.samples > 0 && drawn.report.range_builds == (uint64_t)count);
    for (int s = STRATUS_STRUCTURE_NONE; s <= STRATUS_STRUCTURE_OCTANT; ++s) {
      many.c.options.structure = (stratus_structure)s;
      many.c.options.audit = s != STRATUS_STRUCTURE_NONE;
      draw(context, &many, &other);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
      assert_int_equal(other.report.differing_pixels, 0);
    }
    static uint8_t bytes[4 * CASE_PIXELS];
    stratus_ray_caster* caster = NULL;
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .rgba8 = bytes };
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    for (int again = 0; again < 2; ++again) { /* each component's structures are kept */
      stratus_ray_cast_report report;
      assert_int_equal(
        stratus_ray_caster_render(caster, &many.c.volume, many.transfers, &many.c.camera, &many.c.options, &image, &report), STRATUS_OK);
      assert_int_equal(report.range_builds, count);
      assert_int_equal(report.table_builds, count);
    }
    for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
      assert_int_equal(bytes[i], lrintf(255.0f * other.rgba[i]));
    }
    stratus_ray_caster_destroy(caster);
    many_destroy(&many);
  }
  stratus_context_destroy(context);
}

static void a_function_or_weight_edited_is_seen(void** state)
{
  (void)state;
  static const double green[4] = { 0, 0, 1, 0 };
  static const double flat[4] = { 0, 0, 1e9, 0 };
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 2, 16, 16, 16, 3);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  const stratus_image after = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
  for (int edit = 0; edit < 5; ++edit) {
    assert_int_equal(stratus_ray_caster_render(caster, &m.c.volume, m.transfers, &m.c.camera, &m.c.options, &image, NULL), STRATUS_OK);
    m.transfers[1].color = edit == 0 ? green : m.transfers[1].color;
    m.transfers[1].weight = edit == 1 ? 0.5 : m.transfers[1].weight;
    m.transfers[1].unit_distance = edit == 2 ? 5.0 : m.transfers[1].unit_distance;
    m.transfers[1].gradient = edit == 3 ? flat : m.transfers[1].gradient;
    m.transfers[1].gradient_count = edit >= 3 ? 2 : 0;
    m.c.options.dependent = edit == 4;
    assert_int_equal(stratus_ray_caster_render(caster, &m.c.volume, m.transfers, &m.c.camera, &m.c.options, &after, NULL), STRATUS_OK);
    assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    picture fresh;
    draw(context, &m, &fresh);
    assert_memory_equal(fresh.rgba, other.rgba, sizeof fresh.rgba);
  }
  stratus_ray_caster_destroy(caster);
  many_destroy(&m);
  stratus_context_destroy(context);
}

static void what_it_cannot_show_is_refused(void** state)
{
  (void)state;
  static const double backwards[4] = { 1, 1, 0, 1 };
  stratus_context* context = case_context("host", 1);
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 4, 6, 6, 6, 3);
  m.c.options.dependent = 1;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_UNSUPPORTED); /* 4 of floats */
  m.c.options.dependent = 0;
  m.transfers[2].weight = 1.5;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "1.5"));
  m.transfers[2].weight = 1.0;
  m.transfers[3].gradient = backwards;
  m.transfers[3].gradient_count = 2;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "gradient"));
  m.transfers[3].gradient_count = 0;
  for (int mode = STRATUS_MODE_FIRST_HIT; mode <= STRATUS_MODE_SLICE; ++mode) {
    const bool surfaces = mode == STRATUS_MODE_FIRST_HIT || mode >= STRATUS_MODE_ISOSURFACE;
    m.c.options.mode = (stratus_mode)mode;
    m.c.options.dependent = !surfaces;
    m.c.options.contour_count = 1;
    assert_int_equal(draw_status(context, &m, &drawn), STRATUS_UNSUPPORTED);
    assert_non_null(strstr(stratus_context_message(context), surfaces ? "surfaces" : "dependent"));
  }
  m.c.options.dependent = 0;
  m.c.options.mode = STRATUS_MODE_COMPOSITE;
  m.c.options.gradient_distance = -2.5;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "-2.5"));
  m.c.options.gradient_distance = 0.0;
  m.c.options.label_count = 2;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT); /* without a mask */
  m.c.options.label_count = 0;
  m.c.volume.components = 5;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  m.c.volume.components = 4;
  m.c.volume.value_stride = 3;
  assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* Tables of components and labels have as many entries as the tolerance asks for; of more labels than have room, as many as fit. */
static void components_and_labels_take_the_entries_of_the_tolerance(void** state)
{
  (void)state;
  static const double tolerances[] = { 0.01, 0.001, 0.0001, 0.00001 };
  static uint8_t labels[9 * 8 * 7];
  stratus_context* context = case_context("host", 2);
  for (int kind = 0; kind < 4; ++kind) { /* independent and dependent components, labels, very many labels */
    const int components = kind < 2 ? 2 : 1;
    many m;
    many_create(context, &m, STRATUS_FLOAT32, components, 9, 8, 7, 67);
    m.c.options.dependent = kind == 1;
    m.c.options.sample_distance = 0.5;
    m.c.options.sampling = STRATUS_SAMPLING_AUTO; /* by hand, there is no tolerance */
    stratus_transfer transfers[256];
    if (kind >= 2) {
      set_labels(&m, labels);
    }
    for (int t = 0; t < 256; ++t) {
      transfers[t] = m.transfers[t < 2 ? t : kind < 2 ? 0 : 2];
    }
    m.c.options.label_count = kind == 3 ? 255 : m.c.options.label_count;
    for (size_t t = kind == 3 ? 3 : 0; t < sizeof tolerances / sizeof *tolerances; ++t) {
      const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
      stratus_ray_caster* caster = NULL;
      m.c.options.tolerance = tolerances[t];
      assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
      assert_int_equal(stratus_ray_caster_render(caster, &m.c.volume, transfers, &m.c.camera, &m.c.options, &image, NULL), STRATUS_OK);
      const stratus_ray_shading_tables* tables = &caster->shading_tables;
      const int wanted = stratus_table_entries_for(STRATUS_SAMPLING_MIDPOINT, tolerances[t]);
      assert_true(wanted >= (t < 2 ? 4096 : t == 2 ? 32768 : 65536));
      for (int i = 0; i < (kind < 2 ? components : tables->label_tables_count); ++i) {
        const stratus_table* table = kind < 2 ? tables->tables[i] : tables->label_tables[i];
        assert_true(table->size >= (kind == 3 && wanted > 8192 ? 8192 : wanted));
      }
      stratus_ray_caster_destroy(caster);
    }
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* Gradient opacity, labels and components share their arguments with the light, which is not checked where nothing is lit. */
static void a_count_of_lights_beyond_any_changes_nothing_where_nothing_is_lit(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.0, 0.2, 0.4, 0.45, 1.0 };
  static const int counts[] = { 9, 1024, INT32_MAX, -2, INT32_MIN };
  static uint8_t labels[24 * 22 * 26];
  stratus_context* context = case_context("host", 2);
  for (int kind = 0; kind < 4; ++kind) {
    many m;
    many_create(context, &m, STRATUS_UINT8, kind == 1 ? 2 : 1, 24, 22, 26, 91);
    m.transfers[0].gradient = steep;
    m.transfers[0].gradient_count = kind == 0 ? 3 : 0;
    if (kind == 2) {
      set_labels(&m, labels);
    }
    if (kind == 3) {
      m.c.options.mode = STRATUS_MODE_FIRST_HIT;
      m.c.options.shading.on = 0;
    }
    draw(context, &m, &other);
    assert_true(case_lit(&other) > 50);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
      m.c.options.shading.light_count = counts[i];
      draw(context, &m, &drawn);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    }
    m.c.options.shading.on = m.c.options.shade = 1;
    m.c.options.shading.light_count = 9;
    assert_int_equal(draw_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "9 lights"));
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

int test_ray_components(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(gradient_opacity_thins_as_the_reference_says),
    cmocka_unit_test(gradient_opacity_of_opacities_thins_as_the_reference_says),
    cmocka_unit_test(a_slab_of_opacity_one_shows_its_gradient_opacity),
    cmocka_unit_test(components_that_count_by_their_share_mix_as_the_reference_mixes_them),
    cmocka_unit_test(independent_components_mix_as_the_reference_mixes_them),
    cmocka_unit_test(each_component_has_its_own_units),
    cmocka_unit_test(dependent_components_are_colour_and_opacity),
    cmocka_unit_test(labels_have_colours_and_opacities_of_their_own),
    cmocka_unit_test(components_and_labels_take_the_entries_of_the_tolerance),
    cmocka_unit_test(a_count_of_lights_beyond_any_changes_nothing_where_nothing_is_lit),
    cmocka_unit_test(no_structure_changes_a_bit),
    cmocka_unit_test(each_component_has_a_material_of_its_own),
    cmocka_unit_test(one_value_a_ray_is_found_in_each_component),
    cmocka_unit_test(a_function_or_weight_edited_is_seen),
    cmocka_unit_test(what_it_cannot_show_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
