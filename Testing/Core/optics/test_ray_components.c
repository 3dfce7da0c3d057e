/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes of several components, independent and dependent, compared with the double reference. Also every structure to the bit, each
 * function and weight by its effect, and refusals. */
#include "components_case.h"

#include "ray_modes_render.h"
#include "ray_shading_table.h"
#include "reference_modes.h"
#include "testing.h"
#include "volume.h"

static picture other;

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
    m.c.options.light.shade = count == 2;
    case_camera(context, &m.c, count, 0);
    many_draw(context, &m, &other);
    m.c.options.optics.mean_components = 1;
    snprintf(what, sizeof what, "mean of %d%s", count, m.c.options.light.shade ? ", lit" : "");
    many_check(what, context, &m, MIDPOINT_DB);
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
    for (int t = few_run() ? count % 2 : 0; t < 4; t += few_run() ? 2 : 1) {
      many m;
      char what[64];
      many_create(context, &m, types[t], count, 20, 17, 19, 5u + (uint32_t)(10 * count + t));
      m.transfers[1].weight = 0.4;
      m.transfers[count - 1].gradient = types[t] == STRATUS_UINT8 ? steep : NULL;
      m.transfers[count - 1].gradient_count = types[t] == STRATUS_UINT8 ? 2 : 0;
      m.c.options.light.shade = t % 2;
      case_camera(context, &m.c, count + t, t == 1);
      snprintf(what, sizeof what, "%d of %s%s", count, case_type_names[types[t]], m.c.options.light.shade ? ", lit" : "");
      many_check(what, context, &m, MIDPOINT_DB);
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
    m.c.options.light.shade = 1;
    m.transfers[1].opacity = opacity;
    m.transfers[1].gradient = gradient;
    m.transfers[1].gradient_count = 2;
    many_draw(context, &m, &drawn);
    float* values = m.values;
    for (size_t v = 0; v < 26 * 24 * 28; ++v) {
      values[2 * v + 1] = ldexpf(values[2 * v + 1], power);
    }
    for (int i = 0; i < 4; ++i) {
      opacity[2 * i] = ldexp(opacity[2 * i], power);
    }
    gradient[2] = ldexp(gradient[2], power);
    many_draw(context, &m, &other);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             2^%d: %.1f dB, %d pixels\n", power, db, case_lit(&other));
    assert_true(case_lit(&drawn) > case_share(200));
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
  m.c.options.optics.dependent = 1;
  many_check("2 of float32", context, &m, MIDPOINT_DB);
  m.c.options.light.shade = 1;
  many_check("2 of float32, lit", context, &m, MIDPOINT_DB);
  many_destroy(&m);
  many_create(context, &m, STRATUS_UINT8, 4, 22, 20, 18, 18);
  m.c.options.optics.dependent = 1;
  many_check("4 of uint8", context, &m, MIDPOINT_DB);
  m.c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  m.c.options.sampling.distance = 0.02;
  many_check("4 of uint8, nearest", context, &m, MIDPOINT_DB);
  many_destroy(&m);
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
    m.c.options.optics.gradient_distance = seed % 5 == 0 ? 1.5 : 0.0;
    m.c.options.optics.mean_components = seed % 6 == 0;
    m.c.options.optics.dependent = seed > 8 && (count == 2 || (count == 4 && m.c.volume.type == STRATUS_UINT8));
    m.c.options.light.shade = seed % 3 == 0;
    m.c.options.sampling.distance = 0.7;
    m.c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    many_draw(contexts[0], &m, &drawn);
    lit += case_lit(&drawn) > 0;
    for (int s = STRATUS_STRUCTURE_BLOCK; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      m.c.options.skipping.structure = (stratus_structure)s;
      many_draw(contexts[s % 2], &m, &other);
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
  m.c.options.light.materials = materials;
  many_check("three materials", context, &m, MIDPOINT_DB);
  many_draw(context, &m, &other);
  m.c.options.light.shade = 1; /* says nothing where there are materials */
  many_draw(context, &m, &drawn);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  for (int c = 0; c < COMPONENTS; ++c) { /* all alike is as without */
    const stratus_shading* s = &m.c.options.light.shading;
    materials[c] = (stratus_material){ 1, s->ambient, s->diffuse, s->specular, s->specular_power };
  }
  many_draw(context, &m, &drawn);
  assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  m.c.options.light.materials = NULL;
  many_draw(context, &m, &other);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  m.c.options.light.shade = 0;
  m.c.options.light.materials = materials;
  materials[2].diffuse = -0.5;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "-0.5"));
  materials[2].diffuse = 0.5;
  m.c.options.light.shading.light_count = 9;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  materials[0].shade = materials[1].shade = materials[2].shade = 0; /* no light is read */
  many_draw(context, &m, &drawn);
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* In modes that find one value a ray: pictures of the reference, one for each component, added in double precision. */
static void one_value_a_ray_is_found_in_each_component(void** state)
{
  (void)state;
  static const stratus_mode modes[] = { STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE };
  static float part[4 * CASE_PIXELS_MOST], part_depth[CASE_PIXELS_MOST], sum[4 * CASE_PIXELS_MOST], depth[CASE_PIXELS_MOST];
  stratus_context* context = case_context("host", 2);
  for (int m = 0; m < 4; ++m) {
    many many;
    const int count = 2 + m % 3;
    many_create(context, &many, m == 1 ? STRATUS_UINT8 : STRATUS_FLOAT32, count, 20, 17, 19, 15u + (uint32_t)m);
    many.c.options.mode = modes[m];
    many.c.options.sampling.distance = 0.1;
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
    many_draw(context, &many, &drawn);
    const double db = reference_psnr(drawn.rgba, sum, CASE_PIXELS);
    print_message("             %s of %d: %.1f dB, %d pixels\n", stratus_mode_name(modes[m]), count, db, case_lit(&drawn));
    assert_true(case_lit(&drawn) > case_share(200));
    assert_true(db >= 60.0);
    int grazes = 0; /* rays that touch what counts in a point, which samples meet or miss; measured: 1 */
    for (int i = 0; m > 1 && i < CASE_PIXELS; ++i) {
      grazes += isinf(depth[i]) != isinf(drawn.depth[i]);
    }
    assert_in_range(grazes, 0, 2);
    assert_true(drawn.report.samples > 0 && drawn.report.range_builds == (uint64_t)count);
    for (int s = STRATUS_STRUCTURE_NONE; s <= STRATUS_STRUCTURE_OCTANT; ++s) {
      many.c.options.skipping.structure = (stratus_structure)s;
      many.c.options.skipping.audit = s != STRATUS_STRUCTURE_NONE;
      many_draw(context, &many, &other);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
      assert_int_equal(other.report.differing_pixels, 0);
    }
    static uint8_t bytes[4 * CASE_PIXELS_MOST];
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

/* A surface, or contours, of the case's values. */
static void set_mode(many* m, stratus_mode mode)
{
  const double base = case_type_values[m->c.volume.type].base, scale = case_type_values[m->c.volume.type].scale;
  m->c.options.mode = mode;
  m->c.options.sampling.distance = mode < STRATUS_MODE_ISOSURFACE ? 0.1 : 0.0;
  m->c.options.optics.average_range[0] = base - 0.2 * scale;
  m->c.options.optics.average_range[1] = base + 0.6 * scale;
  m->c.options.optics.contour_count = 2;
  m->c.options.optics.contours[0] = base + 0.4 * scale;
  m->c.options.optics.contours[1] = base + 0.2 * scale;
  m->c.options.slice = (stratus_slice){ .linear = { 1, -2, 0.5 }, .center = { 10, 9, 9 } };
}

/* Compares with the reference, but for rays that graze a surface or what counts, which may meet it in one picture and not in the other. */
static void check_mode(stratus_context* context, const many* m, const char* what, double wanted)
{
  static float expected[4 * CASE_PIXELS_MOST], depth[CASE_PIXELS_MOST];
  int grazes = 0;
  reference_modes_render(&m->c.volume, m->transfers, &m->c.camera, &m->c.options, CASE_WIDTH, CASE_HEIGHT, 0.02, expected, depth);
  many_draw(context, m, &drawn);
  for (int i = 0; m->c.options.mode >= STRATUS_MODE_AVERAGE && i < CASE_PIXELS; ++i) {
    if (fabsf(drawn.rgba[4 * i + 3] - expected[4 * i + 3]) > 0.02f) {
      memcpy(drawn.rgba + 4 * i, expected + 4 * i, 4 * sizeof *expected);
      ++grazes;
    }
  }
  const double db = reference_psnr(drawn.rgba, expected, CASE_PIXELS);
  print_message(
    "             %s, %s: %.1f dB, %d pixels, %d grazing\n", what, stratus_mode_name(m->c.options.mode), db, case_lit(&drawn), grazes);
  assert_true(case_lit(&drawn) >= case_share(20));
  assert_true(db >= wanted);
  assert_in_range(grazes, 0, case_share(6)); /* of the 2288 rays of a large picture */
}

/* The last component is kept, cut or shown, in the colour of the others; sums are of its opacity and the first one's value. */
static void dependent_components_are_drawn_in_every_mode(void** state)
{
  (void)state;
  static const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_UINT8, STRATUS_FLOAT64 };
  static uint8_t mask[22 * 20 * 18];
  stratus_context* context = case_context("host", 2);
  for (size_t i = 0; i < sizeof mask; ++i) {
    mask[i] = (uint8_t)(i % 22 > 5);
  }
  for (int t = 0; t < 3; ++t) {
    for (int mode = STRATUS_MODE_MAXIMUM; mode <= STRATUS_MODE_SLICE; ++mode) {
      many m;
      many_create(context, &m, types[t], types[t] == STRATUS_UINT8 ? 4 : 2, 22, 20, 18, 17u + (uint32_t)t);
      m.c.options.optics.dependent = 1;
      case_camera(context, &m.c, mode, mode % 2);
      set_mode(&m, (stratus_mode)mode);
      /* a colour jumps where the place of an extreme does, between equals that floats separate otherwise */
      check_mode(context, &m, case_type_names[types[t]], stratus_mode_is_extreme((stratus_mode)mode) ? 55.0 : 60.0);
      if (mode < STRATUS_MODE_SLICE) {
        for (int s = STRATUS_STRUCTURE_NONE; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
          m.c.options.skipping.structure = (stratus_structure)s;
          m.c.options.skipping.audit = s != STRATUS_STRUCTURE_NONE;
          many_draw(context, &m, &other);
          assert_int_equal(other.report.differing_pixels, 0);
        }
      }
      if (t == 1) { /* a mask hides what it hides of other volumes */
        m.c.options.mask.bytes = mask;
        check_mode(context, &m, "masked", stratus_mode_is_extreme((stratus_mode)mode) ? 55.0 : 60.0);
      }
      many_destroy(&m);
    }
  }
  stratus_context_destroy(context);
}

/* A slice shows what composite shows of a sample: depths add up, or count by their share. */
static void components_mix_on_a_slice(void** state)
{
  (void)state;
  static const double flat[4] = { 0, 0, 1e9, 0 };
  stratus_context* context = case_context("host", 2);
  for (int count = 2; count <= COMPONENTS; ++count) {
    many m;
    many_create(context, &m, count == 3 ? STRATUS_UINT8 : STRATUS_FLOAT64, count, 22, 20, 18, 27u + (uint32_t)count);
    m.transfers[1].weight = 0.4;
    m.transfers[0].gradient = flat; /* not read, and neither is light */
    m.transfers[0].gradient_count = 2;
    m.c.options.light.shade = 1;
    set_mode(&m, STRATUS_MODE_SLICE);
    case_camera(context, &m.c, 6, 0);
    check_mode(context, &m, "independent", 60.0);
    m.c.options.optics.mean_components = 1;
    check_mode(context, &m, "by their share", 60.0);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* The hits and lights of the last component, in the colour of the others at the voxel that the depth leads to. */
static void first_hits_have_the_colour_of_their_voxel(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (int count = 2; count <= 4; count += 2) {
    many m;
    int clear = 0, near_faces = 0;
    many_create(context, &m, count == 4 ? STRATUS_UINT8 : STRATUS_FLOAT32, count, 22, 20, 18, 37u + (uint32_t)count);
    m.c.options.optics.dependent = 1;
    m.c.options.mode = STRATUS_MODE_FIRST_HIT;
    m.c.options.light.shading.on = 0;
    many_draw(context, &m, &drawn);
    const stratus_volume all = m.c.volume;
    m.c.volume = stratus_volume_component(&all, count - 1);
    m.c.options.optics.dependent = 0;
    many_draw(context, &m, &other);
    assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
    for (int i = 0; i < CASE_PIXELS; ++i) {
      const double u = (2.0 * (i % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (i / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
      double along[3], length = 0.0, expected[4] = { 0 };
      int64_t voxel[3];
      int faces = 0;
      if (!isfinite(drawn.depth[i])) {
        continue;
      }
      for (int a = 0; a < 3; ++a) {
        along[a] = m.c.camera.forward[a] + (m.c.camera.parallel ? 0.0 : u * m.c.camera.right[a] + v * m.c.camera.up[a]);
        length += along[a] * along[a];
      }
      for (int a = 0; a < 3; ++a) { /* just behind the face, and a little farther, where a ray may have left the voxel by an edge */
        const double side = m.c.camera.parallel ? u * m.c.camera.right[a] + v * m.c.camera.up[a] : 0.0;
        const double start = (m.c.camera.eye[a] + side - all.origin[a]) / all.spacing[a], per = along[a] / sqrt(length) / all.spacing[a];
        voxel[a] = (int64_t)floor(start + ((double)drawn.depth[i] + 1e-4) * per + 0.5);
        faces += voxel[a] != (int64_t)floor(start + ((double)drawn.depth[i] + 1e-2) * per + 0.5);
      }
      if (faces) {
        ++near_faces;
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const stratus_volume part = stratus_volume_component(&all, count == 4 ? c : 0);
        const double value = reference_value(&part, voxel[0], voxel[1], voxel[2]);
        stratus_transfer_at(m.transfers, value, expected);
        assert_true(fabs((double)drawn.rgba[4 * i + c] - (count == 4 ? value / 255.0 : expected[c])) < 1e-6);
      }
      ++clear;
    }
    print_message("             %d: %d hits, %d near edges\n", count, clear, near_faces);
    assert_true(clear > 200 && near_faces < clear / 20);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

typedef struct placed_layer {
  reference_layer of;
  int component;
} placed_layer;

static int nearer(const void* a, const void* b)
{
  const placed_layer *p = a, *q = b;
  return p->of.t < q->of.t ? -1 : p->of.t > q->of.t ? 1 : p->component - q->component;
}

/* Surfaces of all components are behind one another by depth, with opacities times the components' weights. */
static void surfaces_of_components_are_in_the_order_of_depth(void** state)
{
  (void)state;
  enum { MOST = 64 };
  static reference_layer found[COMPONENTS][CASE_PIXELS_MOST * MOST];
  static int counts[COMPONENTS][CASE_PIXELS_MOST];
  static float expected[4 * CASE_PIXELS_MOST];
  stratus_context* context = case_context("host", 2);
  for (int count = 2; count <= COMPONENTS; ++count) {
    many m;
    int mixed = 0, grazes = 0;
    many_create(context, &m, count == 3 ? STRATUS_UINT8 : STRATUS_FLOAT32, count, 20, 17, 19, 5u + (uint32_t)count);
    set_mode(&m, STRATUS_MODE_ISOSURFACE);
    case_camera(context, &m.c, count, 0);
    m.transfers[1].weight = 0.6;
    for (int c = 0; c < count; ++c) {
      const stratus_volume view = stratus_volume_component(&m.c.volume, c);
      reference_modes_layers(&view, m.transfers + c, &m.c.camera, &m.c.options, CASE_WIDTH, CASE_HEIGHT, MOST, found[c], counts[c]);
    }
    for (int i = 0; i < CASE_PIXELS; ++i) {
      placed_layer all[COMPONENTS * MOST];
      double left = 1.0, rgb[3] = { 0.0, 0.0, 0.0 };
      int layers = 0;
      for (int c = 0; c < count; ++c) {
        for (int l = 0; l < counts[c][i]; ++l) {
          all[layers] = (placed_layer){ found[c][i * MOST + l], c };
          all[layers++].of.color[3] *= m.transfers[c].weight;
        }
      }
      qsort(all, (size_t)layers, sizeof *all, nearer);
      for (int l = 0; l < layers; ++l) {
        for (int k = 0; k < 3; ++k) {
          rgb[k] += left * all[l].of.color[3] * all[l].of.color[k];
        }
        left *= 1.0 - all[l].of.color[3];
        mixed += l > 1 && all[l].component != all[l - 1].component && all[l].component == all[l - 2].component;
      }
      for (int k = 0; k < 4; ++k) {
        expected[4 * i + k] = (float)(k < 3 ? rgb[k] : 1.0 - left);
      }
    }
    many_draw(context, &m, &drawn);
    for (int i = 0; i < CASE_PIXELS; ++i) {
      if (fabsf(drawn.rgba[4 * i + 3] - expected[4 * i + 3]) > 0.01f) { /* a ray grazes a surface */
        memcpy(drawn.rgba + 4 * i, expected + 4 * i, 4 * sizeof *expected);
        ++grazes;
      }
    }
    const double db = reference_psnr(drawn.rgba, expected, CASE_PIXELS);
    print_message(
      "             %d: %.1f dB, %d pixels, %d grazing, %d surfaces between others\n", count, db, case_lit(&drawn), grazes, mixed);
    assert_true(case_lit(&drawn) > case_share(200) && mixed > case_share(100));
    assert_in_range(grazes, 0, case_share(6));
    assert_true(db >= 60.0);
    m.c.options.skipping.audit = 1;
    many_draw(context, &m, &drawn);
    assert_int_equal(drawn.report.differing_pixels, 0);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* The nearest of the hits of each component, the first component's where two are as near; nothing of a component of weight 0. */
static void the_nearest_hit_of_any_component_shows(void** state)
{
  (void)state;
  static picture each[COMPONENTS];
  stratus_context* context = case_context("host", 2);
  for (int turn = 0; turn < 2; ++turn) {
    many m;
    int of[COMPONENTS] = { 0 };
    many_create(context, &m, STRATUS_FLOAT32, COMPONENTS, 20, 17, 19, 5u);
    m.c.options.mode = STRATUS_MODE_FIRST_HIT;
    m.transfers[0].weight = turn ? 0.0 : 1.0;
    const stratus_volume all = m.c.volume;
    many_draw(context, &m, &drawn);
    for (int c = 0; c < COMPONENTS; ++c) {
      many one = m;
      one.c.volume = stratus_volume_component(&all, c);
      one.transfers[0] = m.transfers[c];
      many_draw(context, &one, &each[c]);
    }
    for (int i = 0; i < CASE_PIXELS; ++i) {
      int nearest = turn;
      for (int c = turn + 1; c < COMPONENTS; ++c) {
        nearest = each[c].depth[i] < each[nearest].depth[i] ? c : nearest;
      }
      assert_memory_equal(&drawn.depth[i], &each[nearest].depth[i], sizeof(float));
      assert_memory_equal(&drawn.rgba[4 * i], &each[nearest].rgba[4 * i], 4 * sizeof(float));
      of[nearest] += isfinite(drawn.depth[i]);
    }
    print_message("             %d, %d, %d and %d hits\n", of[0], of[1], of[2], of[3]);
    assert_true((of[0] > 20) == !turn && of[1] > 20 && of[2] > 20);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* Components with materials of their own are the volumes with these materials. */
static void surfaces_have_the_material_of_their_component(void** state)
{
  (void)state;
  static const stratus_mode modes[] = { STRATUS_MODE_ISOSURFACE, STRATUS_MODE_FIRST_HIT };
  const stratus_material materials[2] = { { 1, 0.1, 0.5, 0.6, 9.0 }, { 0, 0.3, 0.9, 0.0, 1.0 } };
  stratus_context* context = case_context("host", 2);
  for (int mode = 0; mode < 2; ++mode) {
    many m;
    stratus_volume views[2];
    stratus_ray_cast_options options[2];
    stratus_ray_cast_input inputs[2] = { { 0 } };
    many_create(context, &m, STRATUS_FLOAT32, 2, 20, 17, 19, 5u);
    set_mode(&m, modes[mode]);
    for (int c = 0; c < 2; ++c) {
      views[c] = stratus_volume_component(&m.c.volume, c);
      options[c] = m.c.options;
      options[c].light.shade = options[c].light.shading.on = materials[c].shade;
      options[c].light.shading.ambient = materials[c].ambient;
      options[c].light.shading.diffuse = materials[c].diffuse;
      options[c].light.shading.specular = materials[c].specular;
      options[c].light.shading.specular_power = materials[c].specular_power;
      inputs[c] = (stratus_ray_cast_input){ .volume = &views[c], .transfer = m.transfers + c, .options = &options[c] };
      assert_int_equal(stratus_ray_caster_create(context, &inputs[c].caster), STRATUS_OK);
    }
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth };
    assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &m.c.camera, &image, NULL), STRATUS_OK);
    many_draw(context, &m, &drawn);
    assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    m.c.options.light.materials = materials;
    many_draw(context, &m, &drawn);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
    stratus_ray_caster_destroy(inputs[0].caster);
    stratus_ray_caster_destroy(inputs[1].caster);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* A caster goes from mode to mode, by dependent and independent components, and draws what a new one draws. */
static void a_caster_changes_what_it_follows(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  many m;
  many_create(context, &m, STRATUS_UINT8, 4, 16, 15, 14, 3);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  uint32_t random = 5;
  for (int turn = 0; turn < 24; ++turn) {
    const int mode = (int)(case_random(&random) % 8);
    set_mode(&m, (stratus_mode)mode);
    m.c.options.optics.dependent = case_random(&random) % 3 > 0;
    m.c.options.sampling.distance = 0.5;
    assert_int_equal(stratus_ray_caster_render(caster, &m.c.volume, m.transfers, &m.c.camera, &m.c.options, &image, NULL), STRATUS_OK);
    many_draw(context, &m, &other);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof other.rgba);
  }
  stratus_ray_caster_destroy(caster);
  many_destroy(&m);
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
    m.c.options.optics.dependent = edit == 4;
    assert_int_equal(stratus_ray_caster_render(caster, &m.c.volume, m.transfers, &m.c.camera, &m.c.options, &after, NULL), STRATUS_OK);
    assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    picture fresh;
    many_draw(context, &m, &fresh);
    assert_memory_equal(fresh.rgba, other.rgba, 4 * (size_t)CASE_PIXELS * sizeof *fresh.rgba);
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
  many_create(context, &m, STRATUS_FLOAT64, 4, 6, 6, 6, 3);
  m.c.options.optics.dependent = 1;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_UNSUPPORTED);
  assert_non_null(strstr(stratus_context_message(context), "up to 16 bits"));
  m.c.options.optics.dependent = 0;
  m.transfers[2].weight = 1.5;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "1.5"));
  m.transfers[2].weight = 1.0;
  m.transfers[3].gradient = backwards;
  m.transfers[3].gradient_count = 2;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "gradient"));
  m.transfers[3].gradient_count = 0;
  m.c.options.mode = STRATUS_MODE_COMPOSITE;
  m.c.options.optics.gradient_distance = -2.5;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "-2.5"));
  m.c.options.optics.gradient_distance = 0.0;
  m.c.options.mask.label_count = 2;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT); /* without a mask */
  m.c.options.mask.label_count = 0;
  m.c.volume.components = 5;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  m.c.volume.components = 4;
  m.c.volume.value_stride = 3;
  assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
  many_destroy(&m);
  stratus_context_destroy(context);
}

int test_ray_components(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(components_that_count_by_their_share_mix_as_the_reference_mixes_them),
    cmocka_unit_test(independent_components_mix_as_the_reference_mixes_them),
    cmocka_unit_test(each_component_has_its_own_units),
    cmocka_unit_test(dependent_components_are_colour_and_opacity),
    cmocka_unit_test(no_structure_changes_a_bit),
    cmocka_unit_test(each_component_has_a_material_of_its_own),
    cmocka_unit_test(one_value_a_ray_is_found_in_each_component),
    cmocka_unit_test(dependent_components_are_drawn_in_every_mode),
    cmocka_unit_test(components_mix_on_a_slice),
    cmocka_unit_test(first_hits_have_the_colour_of_their_voxel),
    cmocka_unit_test(surfaces_of_components_are_in_the_order_of_depth),
    cmocka_unit_test(the_nearest_hit_of_any_component_shows),
    cmocka_unit_test(surfaces_have_the_material_of_their_component),
    cmocka_unit_test(a_caster_changes_what_it_follows),
    cmocka_unit_test(a_function_or_weight_edited_is_seen),
    cmocka_unit_test(what_it_cannot_show_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
