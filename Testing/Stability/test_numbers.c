/* SPDX-License-Identifier: BSD-3-Clause
 * Numbers at their ends: values and lengths next to nothing or beyond everything, zeros with a sign, pictures of one pixel, volumes of one
 * voxel, views along axes, edges and diagonals, one thread and many. */
#define CASE_FULL_SIZE
#include "picture_case.h"
#include "testing.h"

#define SAME_DB 70.0  /* rounding of floats apart, the same picture */
#define DRAWN_DB 55.0 /* steps of a quarter of a voxel, against the reference */

static picture first, second;

static double db_of(const picture_case* c, const picture* p)
{
  static float truth[4 * CASE_PIXELS_MOST];
  const reference_scene scene = case_scene(c);
  assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 0.25, truth, NULL), 0);
  return reference_psnr(p->rgba, truth, CASE_PIXELS);
}

static void all_are_in_range(const picture* p)
{
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    assert_true(p->rgba[i] >= 0.0f && p->rgba[i] <= 1.0001f); /* false for NaN */
  }
}

static stratus_status try_to_draw(stratus_context* context, const picture_case* c, picture* p)
{
  stratus_ray_caster* caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_status status = stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, &p->report);
  stratus_ray_caster_destroy(caster);
  return status;
}

/* Multiplies values and functions by a factor. */
static void scale_values(picture_case* c, double factor)
{
  const int64_t* n = c->volume.dimensions;
  for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
    if (c->volume.type == STRATUS_FLOAT32) {
      ((float*)c->values)[i] = (float)((double)((float*)c->values)[i] * factor);
    } else {
      ((double*)c->values)[i] *= factor;
    }
  }
  for (int i = 0; i < 4; ++i) {
    c->opacity[2 * i] *= factor;
    c->color[i < 3 ? 4 * i : 0] *= i < 3 ? factor : 1.0;
  }
}

/* From denormal floats and doubles to the largest: drawn as the reference draws them, or refused with a number. First hits have no table of
 * colours, but are coloured by the same floats: if two values are equal as floats, both modes refuse with equal words. */
static void values_of_any_size_are_drawn_or_refused(void** state)
{
  static const double scales[] = { 1e-310, 1e-300, 1e-45, 1e-42, 1e-40, 1e-38, 1e-30, 1e-20, 1e20, 1e30, 1e36, 1e37, 1e100, 1e300 };
  for (size_t i = 0; i < sizeof scales / sizeof *scales; ++i) {
    for (int wide = 0; wide < 2; ++wide) {
      picture_case c;
      case_create(*state, &c, wide ? STRATUS_FLOAT64 : STRATUS_FLOAT32, 14, 15, 16, 3);
      if (wide) { /* values about 1e6 are no field of any size; floats' values are */
        for (int64_t v = 0; v < 14 * 15 * 16; ++v) {
          ((double*)c.values)[v] = (((double*)c.values)[v] - 1e6) * 3000.0 - 20.0;
        }
        const double base = -20.0, scale = 3.0;
        const double opacity[8] = { base - scale, 0, base + 0.02 * scale, 0, base + 0.3 * scale, 0.12, base + scale, 0.4 };
        memcpy(c.opacity, opacity, sizeof opacity);
        c.color[0] = base;
        c.color[4] = base + 0.3 * scale;
        c.color[8] = base + scale;
      } else if (scales[i] > 1.5e37 || scales[i] < 1e-46) {
        case_destroy(&c);
        continue; /* no floats */
      }
      scale_values(&c, scales[i]);
      const stratus_status status = try_to_draw(*state, &c, &first);
      char message[512];
      snprintf(message, sizeof message, "%s", status == STRATUS_OK ? "" : stratus_context_message(*state));
      c.options.mode = STRATUS_MODE_FIRST_HIT;
      const bool alike = strstr(message, "can't separate them") != NULL;
      assert_int_equal(try_to_draw(*state, &c, &second), alike ? status : STRATUS_OK);
      assert_true(alike ? strcmp(stratus_context_message(*state), message) == 0 : case_lit(&second) > 0);
      if (status == STRATUS_OK) {
        all_are_in_range(&first);
        const double db = db_of(&c, &first);
        print_message("             %g of %s: %.1f dB, %d pixels\n", scales[i], case_type_names[c.volume.type], db, case_lit(&first));
        assert_true(db >= DRAWN_DB);
      } else {
        print_message("             %g of %s: %s\n", scales[i], case_type_names[c.volume.type], stratus_context_message(*state));
        assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
        assert_non_null(strpbrk(stratus_context_message(*state), "0123456789"));
      }
      case_destroy(&c);
    }
  }
}

/* Draws a constant volume with holes of one fill value: only values that differ must stay distinct. */
static void a_fill_value_beyond_floats_is_a_hole(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT64, 9, 8, 7, 3);
  for (int i = 0; i < 9 * 8 * 7; ++i) {
    ((double*)c.values)[i] = i % 9 < 3 ? 1e300 : c.opacity[6];
  }
  assert_true(try_to_draw(*state, &c, &first) == STRATUS_OK && case_lit(&first) > 0);
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  assert_true(try_to_draw(*state, &c, &first) == STRATUS_OK && case_lit(&first) > 0);
  ((double*)c.values)[0] = 1e299;
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_FIRST_HIT; ++mode) {
    c.options.mode = (stratus_mode)mode;
    assert_int_equal(try_to_draw(*state, &c, &first), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(*state), "1e+299"));
  }
  case_destroy(&c);
}

/* -0 is 0, in every mode, for functions with points at either. */
static void zeros_have_no_sign(void** state)
{
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_ISOSURFACE; ++mode) {
    for (int nearest = 0; nearest < 2; ++nearest) {
      picture_case c;
      case_create(*state, &c, STRATUS_FLOAT32, 12, 13, 14, 5);
      const double opacity[8] = { -1.0, 0.0, 0.0, 0.0, 0.0, 0.3, 1.0, 0.3 }; /* a step at 0 */
      memcpy(c.opacity, opacity, sizeof opacity);
      c.options.mode = (stratus_mode)mode;
      c.options.sampling.interpolation =
        nearest && mode != STRATUS_MODE_ISOSURFACE ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
      c.options.optics.contour_count = 2;
      c.options.optics.contours[0] = 0.0;
      c.options.optics.contours[1] = 0.25;
      float* values = c.values;
      for (int i = 0; i < 12 * 13 * 14; ++i) {
        values[i] = fmaxf(0.0f, values[i] + 20.0f) / 3.0f;
      }
      case_render(*state, &c, &first);
      assert_true(case_lit(&first) > 0);
      for (int i = 0; i < 12 * 13 * 14; ++i) {
        values[i] = values[i] == 0.0f && i % 2 ? -0.0f : values[i];
      }
      c.opacity[2] = -0.0;
      c.options.optics.contours[0] = -0.0;
      case_render(*state, &c, &second);
      assert_memory_equal(first.rgba, second.rgba, sizeof first.rgba);
      assert_memory_equal(first.depth, second.depth, sizeof first.depth);
      case_destroy(&c);
    }
  }
}

/* Makes a case whose lengths are all multiplied. */
static void create_scaled(stratus_context* context, picture_case* c, int mode, int parallel, double factor)
{
  case_create(context, c, STRATUS_FLOAT32, 14, 15, 16, 3);
  case_camera(context, c, 2, parallel);
  for (int a = 0; a < 3; ++a) {
    c->volume.spacing[a] *= factor;
    c->camera.eye[a] *= factor;
    c->camera.right[a] *= parallel ? factor : 1.0;
    c->camera.up[a] *= parallel ? factor : 1.0;
  }
  c->transfer.unit_distance *= factor;
  c->options.sampling.distance *= factor;
  c->options.mode = (stratus_mode)mode;
  c->options.light.shade = mode == STRATUS_MODE_ISOSURFACE;
  c->options.optics.contour_count = 1;
  c->options.optics.contours[0] = -19.8;
}

/* A picture does not know the unit of length: 1e20 and 1e-20 of it show what 1 shows, and so does every power of ten between. */
static void lengths_of_any_size_show_the_same(void** state)
{
  static const double factors[] = { 1e-20, 1e-12, 1e-6, 1e6, 1e12, 1e20 };
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_ISOSURFACE; ++mode) {
    for (int parallel = 0; parallel < 2; ++parallel) {
      picture_case c;
      create_scaled(*state, &c, mode, parallel, 1.0);
      case_render(*state, &c, &first);
      if (case_lit(&first) < CASE_PIXELS / 50 && mode != STRATUS_MODE_MINIMUM) {
        fail_msg("%s: %d pixels", stratus_mode_name(c.options.mode), case_lit(&first));
      }
      case_destroy(&c);
      for (size_t i = 0; i < sizeof factors / sizeof *factors; ++i) {
        create_scaled(*state, &c, mode, parallel, factors[i]);
        case_render(*state, &c, &second);
        const double db = reference_psnr(first.rgba, second.rgba, CASE_PIXELS);
        if (!(db >= SAME_DB)) {
          fail_msg(
            "%s, %s, lengths of %g: %.1f dB", stratus_mode_name(c.options.mode), parallel ? "parallel" : "perspective", factors[i], db);
        }
        for (int p = 0; p < CASE_PIXELS; ++p) {
          assert_int_equal(isfinite(first.depth[p]), isfinite(second.depth[p]));
          if (isfinite(first.depth[p])) {
            assert_true(fabs((double)second.depth[p] / factors[i] - (double)first.depth[p]) <= 1e-3 * (double)first.depth[p]);
          }
        }
        case_destroy(&c);
      }
    }
  }
}

/* Edges of 1e-20 and 1e20 in one voxel, positions that are equal in doubles: drawn with finite numbers only, or refused. */
static void lengths_that_do_not_go_together_are_drawn_or_refused(void** state)
{
  static const double edges[][6] = { { 1e-20, 1, 1e20, 0, 0, 0 }, { 1e-20, 1e-20, 1, 0, 0, 0 }, { 1, 1, 1, 1e20, 0, 0 },
    { 1e-20, 1e-20, 1e-20, 1, 1, 1 }, { 1e150, 1e150, 1e150, 0, 0, 0 }, { 1e-150, 1e-150, 1e-150, 0, 0, 0 },
    { 1e300, 1e300, 1e300, 0, 0, 0 }, { 1e-310, 1e-310, 1e-310, 0, 0, 0 }, { 1e20, 1e20, 1e20, 1e40, 1e40, 1e40 } };
  for (size_t i = 0; i < sizeof edges / sizeof *edges; ++i) {
    for (int parallel = 0; parallel < 2; ++parallel) {
      picture_case c;
      double bounds[6];
      case_create(*state, &c, STRATUS_FLOAT32, 9, 8, 7, 4);
      for (int a = 0; a < 3; ++a) {
        c.volume.spacing[a] = edges[i][a];
        c.volume.origin[a] = edges[i][3 + a];
      }
      c.transfer.unit_distance = edges[i][1];
      c.options.sampling.rule = STRATUS_SAMPLING_AUTO;
      c.options.sampling.distance = 0.0;
      stratus_status status = stratus_volume_bounds(*state, &c.volume, bounds);
      if (status == STRATUS_OK) {
        status = stratus_scene_camera(*state, bounds, 2, 0, parallel, 1.2, &c.camera);
      }
      if (status == STRATUS_OK) {
        status = try_to_draw(*state, &c, &first);
      }
      if (status == STRATUS_OK) {
        all_are_in_range(&first);
      } else {
        assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
        if (!strpbrk(stratus_context_message(*state), "0123456789")) {
          fail_msg("no number: %s", stratus_context_message(*state));
        }
      }
      print_message("             edges %g %g %g at %g: %s\n", edges[i][0], edges[i][1], edges[i][2], edges[i][3],
        status == STRATUS_OK ? "drawn" : stratus_context_message(*state));
      case_destroy(&c);
    }
  }
}

static void threads_change_no_bit_of_any_mode(void** state)
{
  static const int threads[] = { 1, 2, 64 };
  (void)state;
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_ISOSURFACE; ++mode) {
    for (int t = 0; t < 3; ++t) {
      stratus_context* context = case_context("host", threads[t]);
      picture_case c;
      create_scaled(context, &c, mode, 0, 1.0);
      c.options.skipping.structure = STRATUS_STRUCTURE_HYBRID;
      case_render(context, &c, t ? &second : &first);
      if (t > 0) {
        assert_memory_equal(first.rgba, second.rgba, sizeof first.rgba);
        assert_memory_equal(first.depth, second.depth, sizeof first.depth);
      }
      case_destroy(&c);
      stratus_context_destroy(context);
    }
  }
}

/* The middle pixel of any odd picture is the ray straight ahead. */
static void pictures_of_1_and_3_pixels_show_their_rays(void** state)
{
  static const int sizes[][2] = { { 1, 1 }, { 3, 1 }, { 1, 3 }, { 3, 3 }, { 45, 3 }, { 1, 65 } };
  float rgba[4 * 135], depth[135];
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_ISOSURFACE; ++mode) {
    for (int parallel = 0; parallel < 2; ++parallel) {
      float middle[4] = { 0 }, place = 0.0f;
      for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
        const int width = sizes[i][0], height = sizes[i][1], at = height / 2 * width + width / 2;
        const stratus_image image = { .width = width, .height = height, .rgba = rgba, .depth = depth };
        stratus_ray_caster* caster = NULL;
        picture_case c;
        create_scaled(*state, &c, mode, parallel, 1.0);
        assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
        c.options.skipping.audit = 1;
        stratus_ray_cast_report report;
        assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
        assert_int_equal(report.differing_pixels, 0);
        if (i == 0) {
          memcpy(middle, rgba, sizeof middle);
          place = depth[0];
          if (!(middle[3] > 0.0f) && mode != STRATUS_MODE_MINIMUM) { /* the least value may be transparent */
            fail_msg("%s: nothing in the middle", stratus_mode_name(c.options.mode));
          }
        }
        assert_memory_equal(rgba + 4 * at, middle, sizeof middle);
        assert_memory_equal(depth + at, &place, sizeof place);
        stratus_ray_caster_destroy(caster);
        case_destroy(&c);
      }
    }
  }
}

/* One value: a point has no size, and a cell is a cube of one colour, which is a closed form. */
static void volumes_of_one_voxel_are_cubes_or_nothing(void** state)
{
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_ISOSURFACE; ++mode) {
    for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
      for (int cell = 0; cell < 2; ++cell) {
        for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
          picture_case c;
          case_create(*state, &c, (stratus_type)type, 2, 1, 1, 1);
          c.volume.dimensions[0] = 1;
          const double base = case_type_values[type].base, scale = case_type_values[type].scale;
          case_store(c.values, (stratus_type)type, 0, base + 0.9 * scale);
          c.volume.cell_centered = cell;
          c.options.mode = (stratus_mode)mode;
          c.options.skipping.structure = (stratus_structure)structure;
          c.options.optics.contour_count = 1;
          c.options.optics.contours[0] = base;
          const double eye[3] = { 0.5, 0.5, 5.0 }, focal[3] = { 0.5, 0.5, 0.5 }, up[3] = { 0, 1, 0 };
          assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 1.0, (double)CASE_WIDTH / CASE_HEIGHT, &c.camera), STRATUS_OK);
          case_render(*state, &c, &first);
          all_are_in_range(&first);
          const int lit = case_lit(&first);
          const bool solid = mode == STRATUS_MODE_FIRST_HIT; /* a voxel is a cube, of a point, too */
          const bool shows = solid || (cell && mode != STRATUS_MODE_ISOSURFACE);
          if (shows != (lit > 0)) {
            fail_msg("%s of one %s %s: %d pixels", stratus_mode_name(c.options.mode), case_type_names[type], cell ? "cell" : "point", lit);
          }
          if (mode == STRATUS_MODE_COMPOSITE && cell) {
            const double db = db_of(&c, &first);
            assert_true(db >= DRAWN_DB);
          }
          case_destroy(&c);
        }
      }
    }
  }
}

/* All 26 directions through middles of faces, edges and corners: rays are in planes of the grid. */
static void views_along_axes_edges_and_diagonals_are_right(void** state)
{
  double worst = INFINITY;
  for (int direction = 0; direction < 27; ++direction) {
    const int d[3] = { direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1 };
    for (int kind = 0; kind < 4 && direction != 13; ++kind) {
      picture_case c;
      double eye[3], focal[3];
      case_create(*state, &c, STRATUS_FLOAT32, 13, 13, 13, 6);
      for (int a = 0; a < 3; ++a) {
        focal[a] = 6.0; /* a point of the grid */
        eye[a] = focal[a] + 20.0 * d[a];
      }
      const double upward[3] = { d[0] == 0, d[0] != 0 && d[1] == 0, d[0] != 0 && d[1] != 0 }; /* along an axis, and not along the view */
      assert_int_equal(kind & 1 ? stratus_camera_parallel(*state, eye, focal, upward, 6.6, (double)CASE_WIDTH / CASE_HEIGHT, &c.camera)
                                : stratus_camera_perspective(*state, eye, focal, upward, 35.0, (double)CASE_WIDTH / CASE_HEIGHT, &c.camera),
        STRATUS_OK);
      c.options.sampling.rule = kind & 2 ? STRATUS_SAMPLING_CELLS : STRATUS_SAMPLING_MIDPOINT;
      c.options.skipping.audit = 1;
      case_render(*state, &c, &first);
      assert_int_equal(first.report.differing_pixels, 0);
      const double db = db_of(&c, &first);
      worst = fmin(worst, db);
      if (!(db >= DRAWN_DB)) {
        fail_msg("along %d %d %d, %s, %s: %.1f dB", d[0], d[1], d[2], kind & 1 ? "parallel" : "perspective",
          stratus_sampling_name(c.options.sampling.rule), db);
      }
      for (int mode = STRATUS_MODE_FIRST_HIT; mode <= STRATUS_MODE_ISOSURFACE; ++mode) {
        c.options.mode = (stratus_mode)mode;
        c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
        c.options.optics.contour_count = 1;
        c.options.optics.contours[0] = -19.8;
        case_render(*state, &c, &first);
        assert_int_equal(first.report.differing_pixels, 0);
        all_are_in_range(&first);
        if (case_lit(&first) == 0 && mode != STRATUS_MODE_MINIMUM) { /* the least value may be transparent */
          fail_msg("along %d %d %d, %s: nothing", d[0], d[1], d[2], stratus_mode_name(c.options.mode));
        }
      }
      case_destroy(&c);
    }
  }
  print_message("             worst %.1f dB\n", worst);
}

int test_numbers(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(values_of_any_size_are_drawn_or_refused),
    cmocka_unit_test(a_fill_value_beyond_floats_is_a_hole),
    cmocka_unit_test(zeros_have_no_sign),
    cmocka_unit_test(lengths_of_any_size_show_the_same),
    cmocka_unit_test(lengths_that_do_not_go_together_are_drawn_or_refused),
    cmocka_unit_test(threads_change_no_bit_of_any_mode),
    cmocka_unit_test(pictures_of_1_and_3_pixels_show_their_rays),
    cmocka_unit_test(volumes_of_one_voxel_are_cubes_or_nothing),
    cmocka_unit_test(views_along_axes_edges_and_diagonals_are_right),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
