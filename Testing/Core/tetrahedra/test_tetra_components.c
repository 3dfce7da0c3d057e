/* SPDX-License-Identifier: BSD-3-Clause
 * Values of several components in tetrahedra against a reference in double precision, which intersects rays with cells once for each
 * component and integrates in many steps: independent and dependent ones, of points and of cells, lists and lattices, in all modes. */
#include "tetra_light_case.h"

#include "tetra_caster.h"
#include "testing.h"

#define COMPONENTS 4
#define STEPS 200

typedef struct several {
  tetra_case whole;            /* the drawn case: all components */
  tetra_case part[COMPONENTS]; /* each component as a separate mesh, for the reference */
  float* values[COMPONENTS];
  void* all;
  stratus_transfer transfers[COMPONENTS];
  double opacity[COMPONENTS][6], gradient[6];
  stratus_material materials[COMPONENTS];
  int count;
} several;

static tetra_picture picture, other;
static double reference[4 * TETRA_PIXELS_MOST];

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

static void color_of(const stratus_transfer* t, double value, double rgb[3])
{
  for (size_t k = 0; k < 3; ++k) {
    rgb[k] = linear_between(t->color, t->color_count, 4, k + 1, value);
  }
}

/* A step of a ray through a cell: the values of all components there, and its place. */
typedef struct ray_step {
  int64_t cell;
  double value[COMPONENTS], place[3], along[3], length;
} ray_step;

typedef struct spaces {
  tetra_space world[COMPONENTS], local[COMPONENTS]; /* of each component's gradients */
} spaces;

/* Adds a step. */
static void add_step(const several* s, const spaces* in, const ray_step* step, double out[4])
{
  const stratus_tetra_options* o = &s->whole.options;
  double depth = 0.0, squares = 0.0, glow[3] = { 0.0, 0.0, 0.0 };
  for (int c = o->dependent ? s->count - 1 : 0; c < s->count; ++c) {
    const tetra_case* part = s->part + c;
    const double alpha = tetra_thinned(part, in->world + c, in->local + c, step->cell, step->place, step->value[c], step->length);
    const double own = -log1p(-alpha) / step->length * (o->dependent ? 1.0 : s->transfers[c].weight);
    double rgb[3], g[3];
    color_of(&part->transfer, step->value[o->dependent ? 0 : c], rgb);
    for (int k = 0; k < 3 && o->dependent && s->count == 4; ++k) {
      rgb[k] = step->value[k] / 255.0;
    }
    if (o->materials && !o->dependent ? o->materials[c].shade : o->shade) {
      tetra_gradient_at(part, in->world + c, in->world + c, step->cell, step->place, g);
      tetra_illuminate(part, step->place, step->along, g, rgb);
    }
    for (int k = 0; k < 3; ++k) {
      glow[k] += own * rgb[k];
    }
    depth += own;
    squares += own * own;
  }
  depth = o->mean_components && !o->dependent && depth > 0.0 ? squares / depth : depth;
  const double alpha = -expm1(-depth * step->length);
  for (int k = 0; k < 3 && depth > 0.0; ++k) {
    out[k] += (1.0 - out[3]) * alpha * glow[k] / depth;
  }
  out[3] += (1.0 - out[3]) * alpha;
}

typedef struct met_cell {
  tetra_stretch of[COMPONENTS];
  int64_t cell;
} met_cell;

static int nearer(const void* a, const void* b)
{
  return tetra_nearer(((const met_cell*)a)->of, ((const met_cell*)b)->of);
}

static void add_cell(const several* s, const spaces* in, const met_cell* met, const double origin[3], const double along[3], double out[4])
{
  const double length = (met->of[0].to - met->of[0].from) * sqrt(tetra_dot(along, along)) / STEPS;
  for (int step = 0; step < STEPS; ++step) {
    const double t = (step + 0.5) / STEPS, at = met->of[0].from + t * (met->of[0].to - met->of[0].from);
    ray_step r = { .cell = met->cell, .length = length };
    for (int c = 0; c < s->count; ++c) {
      r.value[c] = met->of[c].first + t * (met->of[c].last - met->of[c].first);
    }
    for (int a = 0; a < 3; ++a) {
      r.along[a] = along[a];
      r.place[a] = origin[a] + at * along[a];
    }
    add_step(s, in, &r, out);
  }
}

typedef void add_ray(const several* s, const met_cell* met, size_t count, const double origin[3], const double along[3], double out[4]);

/* Draws the reference by what `add` makes of each ray's cells. */
static void draw_by(const several* s, add_ray* add)
{
  const stratus_camera* k = &s->whole.camera;
  met_cell* met = calloc((size_t)s->part[0].mesh.cell_count + 1, sizeof *met);
  assert_non_null(met);
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    const double u = (2.0 * (pixel % TETRA_WIDTH) + 1.0) / TETRA_WIDTH - 1.0, v = (2.0 * (pixel / TETRA_WIDTH) + 1.0) / TETRA_HEIGHT - 1.0;
    double origin[3], along[3], *out = reference + 4 * pixel;
    size_t count = 0;
    for (int a = 0; a < 3; ++a) {
      const double side = u * k->right[a] + v * k->up[a];
      origin[a] = k->eye[a] + (k->parallel ? side : 0.0);
      along[a] = k->forward[a] + (k->parallel ? 0.0 : side);
    }
    for (int64_t cell = 0; cell < s->part[0].mesh.cell_count; ++cell) {
      int meets = 1;
      for (int c = 0; c < s->count; ++c) {
        meets = meets && tetra_meet(s->part + c, cell, origin, along, k->near_k, k->far_k, &met[count].of[c]);
      }
      met[count].cell = cell;
      count += (size_t)meets;
    }
    qsort(met, count, sizeof *met, nearer);
    memset(out, 0, 4 * sizeof *out);
    add(s, met, count, origin, along, out);
  }
  free(met);
}

static spaces spaces_now; /* of the reference that is drawn */

static void add_all(const several* s, const met_cell* met, size_t count, const double origin[3], const double along[3], double out[4])
{
  for (size_t i = 0; i < count; ++i) {
    add_cell(s, &spaces_now, met + i, origin, along, out);
  }
}

static void draw_reference(several* s, add_ray* add)
{
  for (int c = 0; c < s->count; ++c) {
    const stratus_material* m = s->whole.options.dependent ? NULL : s->whole.options.materials;
    stratus_shading* shading = &s->part[c].options.shading;
    s->part[c].options = s->whole.options;
    s->part[c].camera = s->whole.camera;
    s->part[c].transfer = s->transfers[s->whole.options.dependent ? 0 : c];
    if (m) {
      shading->ambient = m[c].ambient;
      shading->diffuse = m[c].diffuse;
      shading->specular = m[c].specular;
      shading->specular_power = m[c].specular_power;
    }
    spaces_now.world[c] = tetra_space_create(s->part + c, 1);
    spaces_now.local[c] = tetra_space_create(s->part + c, 0);
  }
  draw_by(s, add);
  for (int c = 0; c < s->count; ++c) {
    tetra_space_destroy(spaces_now.world + c);
    tetra_space_destroy(spaces_now.local + c);
  }
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

/* Two lights; with two or more components, materials of their own, of which one is not lit. */
static void set_light(several* s, int own)
{
  static const stratus_light lights[2] = { { .vector = { -1.0, 2.0, 1.5 }, .color = { 1.0, 0.8, 0.6 } },
    { .vector = { 5.0, 6.0, 7.0 }, .color = { 2.0, 2.0, 2.0 }, .positional = 1, .attenuation = { 1.0, 0.2, 0.05 } } };
  static const stratus_material materials[COMPONENTS] = { { 1, 0.1, 0.9, 0.5, 30.0 }, { 1, 0.4, 0.5, 0.0, 1.0 }, { 0, 0.0, 0.0, 0.0, 0.0 },
    { 1, 0.0, 0.8, 0.2, 5.0 } };
  stratus_shading* shading = &s->whole.options.shading;
  shading->ambient = 0.2;
  shading->diffuse = 0.7;
  shading->specular = 0.4;
  shading->specular_power = 20.0;
  shading->light_count = 2;
  memcpy(shading->lights, lights, sizeof lights);
  memcpy(s->materials, materials, sizeof materials);
  s->whole.options.shade = !own;
  s->whole.options.materials = own ? s->materials : NULL;
}

/* Gradient opacity of every other component, or of all dependent ones. */
static void set_thin(several* s, double unit)
{
  memcpy(s->gradient, (const double[6]){ 0.1 * unit, 0.0, 0.5 * unit, 0.6, 1.2 * unit, 1.0 }, sizeof s->gradient);
  for (int c = 0; c < s->count; c += 2) {
    s->transfers[c].gradient = s->gradient;
    s->transfers[c].gradient_count = 3;
  }
}

/* The default tolerance is a quarter of a step of 255. */
static void compare_with_reference(stratus_context* context, several* s, uint32_t seed)
{
  double largest;
  for (int c = 0; c < s->count; ++c) {
    s->part[c].mesh.cell_values = s->whole.mesh.cell_values;
  }
  tetra_camera(context, &s->whole, 3, (int)(seed % 8), seed & 1);
  draw_reference(s, add_all);
  draw(context, s, &picture);
  const double error = tetra_error(picture.rgba, reference, &largest);
  if (!(error < 0.255)) {
    print_error("seed %u, %d components: %.3f of 255, at most %.2f\n", seed, s->count, error, largest);
  }
  assert_true(error < 0.255);
}

/* Light and opacity by gradients are cut into pieces by bounds, within the same tolerance. */
static void lit_components_are_right(void** state)
{
  for (uint32_t seed = 0; seed < 16; seed += few_run() ? 5 : 1) {
    several s;
    const int kind = (int)(seed % 4); /* independent, their mean, 2 and 4 dependent */
    create(&s, 3, kind == 3 ? 4 : kind == 2 ? 2 : 2 + (int)(seed / 4) % 3, kind == 3, seed);
    s.whole.options.mean_components = kind == 1;
    s.whole.options.dependent = kind > 1;
    s.whole.mesh.cell_values = seed / 4 == 1;
    if (seed / 4 != 2) {
      set_light(&s, kind < 2 && seed / 4 > 0);
    }
    if (seed / 4 > 1) {
      set_thin(&s, kind == 3 ? 255.0 : 1.0);
      s.whole.options.gradient_distance = seed % 2 == 1 ? 0.5 : 0.0;
    }
    compare_with_reference(*state, &s, seed);
    destroy(&s);
  }
}

static void components_are_right(void** state)
{
  for (uint32_t seed = 0; seed < 12; seed += few_run() ? 5 : 1) {
    several s;
    const int kind = (int)(seed % 4); /* independent, their mean, 2 and 4 dependent */
    create(&s, 3, kind == 3 ? 4 : kind == 2 ? 2 : 2 + (int)(seed / 4), kind == 3, seed);
    s.whole.options.mean_components = kind == 1;
    s.whole.options.dependent = kind > 1;
    s.whole.mesh.cell_values = seed / 4 == 1;
    compare_with_reference(*state, &s, seed);
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
  for (int lit = 0; lit < 3; ++lit) {
    if (lit > 0) {
      set_light(&s, 0);
      set_thin(&s, lit == 2 ? 1.0 : 1e-9);
      s.transfers[1].gradient = s.gradient;
      s.transfers[1].gradient_count = 3;
      one.transfers[0].gradient = s.gradient;
      one.transfers[0].gradient_count = 3;
      one.whole.options.shading = s.whole.options.shading;
      one.whole.options.shade = 1;
    }
    draw(*state, &s, &picture);
    draw(*state, &one, &other);
    double squares = 0.0;
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      squares += pow((double)(picture.rgba[i] - other.rgba[i]), 2.0);
      assert_true(lit || fabs((double)(picture.rgba[i] - other.rgba[i])) < 1e-3);
    }
    if (!(sqrt(squares / (4 * TETRA_PIXELS)) < 1e-3)) {
      print_error("lit %d: %g\n", lit, sqrt(squares / (4 * TETRA_PIXELS)));
    }
    assert_true(sqrt(squares / (4 * TETRA_PIXELS)) < 1e-3); /* the tolerance */
  }
  ((float*)s.all)[2 * 62 + 1] = NAN;
  draw(*state, &s, &picture);
  assert_true(picture.report.blanked > 0);
  destroy(&s);
  destroy(&one);
}

/* In modes that find one value a ray, each component is drawn by itself: premultiplied colours and alphas, times weights, add up. */
static void add_references(several* s, double* known)
{
  const int opaque = s->whole.options.mode == STRATUS_TETRA_AVERAGE || s->whole.options.mode == STRATUS_TETRA_ADDITIVE;
  memset(known, 0, 4 * TETRA_PIXELS_MOST * sizeof *known);
  for (int c = 0; c < s->count; ++c) {
    static double depth[TETRA_PIXELS_MOST];
    s->part[c].transfer = s->transfers[c];
    s->part[c].options = s->whole.options;
    s->part[c].camera = s->whole.camera;
    tetra_reference(&s->part[c], reference, depth);
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      known[i] = opaque && i % 4 == 3 ? fmax(known[i], reference[i]) : fmin(known[i] + s->transfers[c].weight * reference[i], 1.0);
    }
  }
}

/* Values are rounded to the tables' 32768 entries, as in test_tetra_modes, of each component. */
static void modes_of_components_are_right(void** state)
{
  static double known[4 * TETRA_PIXELS_MOST];
  for (uint32_t seed = 0; seed < 16; seed += few_run() ? 5 : 1) {
    several s;
    const stratus_tetra_mode mode = (stratus_tetra_mode)(STRATUS_TETRA_MAXIMUM + seed % 4);
    create(&s, 3, 2 + (int)(seed / 4) % 3, seed / 4 == 2, seed);
    s.whole.options.mode = mode;
    s.whole.options.method = STRATUS_TETRA_METHOD_AUTO;
    s.whole.mesh.cell_values = seed / 4 == 1;
    s.whole.options.average_range[0] = seed / 4 == 3 ? 0.3 : -(double)INFINITY;
    for (int c = 0; c < s.count; ++c) {
      s.part[c].mesh.cell_values = s.whole.mesh.cell_values;
      s.transfers[c].unit_distance = 6.0; /* sums below 1 */
    }
    tetra_camera(*state, &s.whole, 3, (int)(seed % 8), seed & 1);
    add_references(&s, known);
    draw(*state, &s, &picture);
    double largest;
    const double error = tetra_error(picture.rgba, known, &largest);
    if (!(error < 0.1 * s.count)) {
      print_error(
        "seed %u, %d components, mode %s: %.3f of 255, at most %.2f\n", seed, s.count, stratus_tetra_mode_name(mode), error, largest);
    }
    assert_true(error < 0.1 * s.count);
    assert_int_equal(picture.report.method, STRATUS_TETRA_METHOD_MARCH);
    destroy(&s);
  }
}

/* Adds a layer of the colour at the part t of a cell, by the last of dependent components, or by all independent ones. */
static void add_layer(const several* s, const met_cell* met, double t, double out[4])
{
  const stratus_tetra_options* o = &s->whole.options;
  double depth = 0.0, squares = 0.0, glow[3] = { 0.0, 0.0, 0.0 }, value[COMPONENTS], rgb[3];
  for (int c = 0; c < s->count; ++c) {
    value[c] = met->of[c].first + t * (met->of[c].last - met->of[c].first);
  }
  for (int c = o->dependent ? s->count - 1 : 0; c < s->count; ++c) {
    const stratus_transfer* f = s->transfers + (o->dependent ? 0 : c);
    const double opacity = linear_between(f->opacity, f->opacity_count, 2, 1, value[c]);
    const double own = -log1p(-fmin(opacity, 1.0 - 1e-15)) * (o->dependent ? 1.0 : f->weight);
    color_of(f, value[o->dependent ? 0 : c], rgb);
    for (int k = 0; k < 3; ++k) {
      glow[k] += own * (o->dependent && s->count == 4 ? value[k] / 255.0 : rgb[k]);
    }
    depth += own;
    squares += own * own;
  }
  const double glows = depth;
  depth = o->mean_components && !o->dependent && depth > 0.0 ? squares / depth : depth;
  const double alpha = -expm1(-depth);
  for (int k = 0; k < 3 && glows > 0.0; ++k) {
    out[k] += (1.0 - out[3]) * alpha * glow[k] / depth;
  }
  out[3] += (1.0 - out[3]) * alpha;
}

/* Draws the cells that a ray meets, nearest first, by the mode: what the last of dependent components shows, in the others' colours. */
static void add_cells(const several* s, const met_cell* met, size_t count, const double origin[3], const double along[3], double out[4])
{
  const stratus_tetra_options* o = &s->whole.options;
  const stratus_transfer* f = s->transfers;
  const int last = s->count - 1;
  const double sign = o->mode == STRATUS_TETRA_MINIMUM ? -1.0 : 1.0, length = sqrt(tetra_dot(along, along));
  double best = -INFINITY, sum = 0.0, counted = 0.0, range[2];
  tetra_range(s->part, range);
  for (size_t i = 0; i < count && !(o->mode == STRATUS_TETRA_FIRST_HIT && out[3] > 0.0); ++i) {
    const tetra_stretch* cut = met[i].of + last;
    for (int end = 0; end < 2 && o->mode <= STRATUS_TETRA_MINIMUM; ++end) {
      const double value = sign * (end ? cut->last : cut->first);
      if (value > best) {
        best = value;
        memset(out, 0, 4 * sizeof *out);
        add_layer(s, met + i, end, out);
      }
    }
    if (o->mode == STRATUS_TETRA_AVERAGE || o->mode == STRATUS_TETRA_ADDITIVE) {
      for (int step = 0; step < STEPS; ++step) {
        const double t = (step + 0.5) / STEPS, part = (cut->to - cut->from) * length / STEPS;
        const double grey = met[i].of[0].first + t * (met[i].of[0].last - met[i].of[0].first);
        const double opacity = linear_between(f->opacity, f->opacity_count, 2, 1, cut->first + t * (cut->last - cut->first));
        if (o->mode == STRATUS_TETRA_ADDITIVE || (grey >= o->average_range[0] && grey <= o->average_range[1])) {
          sum += opacity * (grey - range[0]) / (range[1] - range[0]) * part;
          counted += part;
        }
      }
      out[3] = counted > 0.0;
      out[0] = out[1] = out[2] = counted > 0.0 ? fmin(sum / (o->mode == STRATUS_TETRA_AVERAGE ? counted : f->unit_distance), 1.0) : 0.0;
    }
    const double contour = o->contours[0], at = (contour - cut->first) / (cut->last - cut->first);
    if (o->mode == STRATUS_TETRA_ISOSURFACE && (cut->first < contour) != (cut->last < contour)) {
      add_layer(s, met + i, at, out);
    }
    const double a = tetra_slice_at(&o->slice, origin, along, cut->from), b = tetra_slice_at(&o->slice, origin, along, cut->to);
    if (o->mode == STRATUS_TETRA_SLICE && (a < 0.0) != (b < 0.0)) {
      add_layer(s, met + i, a / (a - b), out);
    }
    for (int step = 0; step <= 10 * STEPS && o->mode == STRATUS_TETRA_FIRST_HIT && !(out[3] > 0.0); ++step) {
      const double t = (double)step / (10 * STEPS);
      if (linear_between(f->opacity, f->opacity_count, 2, 1, cut->first + t * (cut->last - cut->first)) > 0.0) {
        add_layer(s, met + i, t, out);
        for (int k = 0; k < 3; ++k) {
          out[k] /= out[3];
        }
        out[3] = 1.0;
      }
    }
  }
}

/* Values are rounded to tables; the reference's first hits and sums are steps. */
static void dependent_components_in_all_modes(void** state)
{
  for (uint32_t seed = 0; seed < 18; ++seed) {
    several s;
    const bool mixes = seed >= 14, four = seed % 2 == 1 && !mixes; /* the last ones: slices of independent components, and their mean */
    double largest;
    create(&s, 3, four ? 4 : 2 + (int)(seed > 15), four, seed);
    if (four && seed % 4 == 3) { /* floats of the same values */
      const int64_t count = 4 * (s.whole.mesh.point_count > s.whole.mesh.cell_count ? s.whole.mesh.point_count : s.whole.mesh.cell_count);
      float* floats = calloc((size_t)count, sizeof *floats);
      assert_non_null(floats);
      for (int64_t i = 0; i < count; ++i) {
        floats[i] = (float)((uint8_t*)s.all)[i];
      }
      free(s.all);
      s.whole.mesh.values = s.all = floats;
      s.whole.mesh.type = STRATUS_FLOAT32;
    }
    stratus_tetra_options* o = &s.whole.options;
    const double unit = four ? 255.0 : 1.0;
    o->mode = mixes ? STRATUS_TETRA_SLICE : (stratus_tetra_mode)(STRATUS_TETRA_MAXIMUM + seed / 2 % 7);
    o->dependent = !mixes;
    o->mean_components = mixes && seed % 2 == 1;
    o->contour_count = 1;
    o->contours[0] = 0.55 * unit;
    o->average_range[0] = 0.3 * unit;
    o->average_range[1] = 0.8 * unit;
    o->slice = (stratus_slice){ .center = { 1.4, 1.5, 1.6 }, .linear = { 1, 0.5, -0.7 } };
    s.whole.mesh.cell_values = seed % 3 == 1 && o->mode != STRATUS_TETRA_ISOSURFACE;
    for (int c = 0; c < s.count; ++c) {
      s.part[c].mesh.cell_values = s.whole.mesh.cell_values;
      s.transfers[c].unit_distance = o->mode == STRATUS_TETRA_ADDITIVE ? 6.0 : 0.7 + 0.4 * c;
      s.part[c].transfer = s.transfers[o->dependent ? 0 : c];
      s.part[c].options = *o;
    }
    tetra_camera(*state, &s.whole, 3, (int)(seed % 8), seed & 1);
    draw_by(&s, add_cells);
    draw(*state, &s, &picture);
    const double error = tetra_error(picture.rgba, reference, &largest);
    if (!(error < 0.5)) {
      print_error(
        "seed %u, %d components, mode %s: %.3f of 255, at most %.2f\n", seed, s.count, stratus_tetra_mode_name(o->mode), error, largest);
    }
    assert_true(error < 0.5);
    destroy(&s);
  }
}

static double opacity_of(const several* s, int c, double value)
{
  return s->transfers[c].weight * linear_between(s->transfers[c].opacity, s->transfers[c].opacity_count, 2, 1, value);
}

/* Adds the surfaces of all components in their order along the cells that a ray meets, each in its component's colour and light. */
static void add_surfaces(const several* s, const met_cell* met, size_t count, const double origin[3], const double along[3], double out[4])
{
  const stratus_tetra_options* o = &s->whole.options;
  for (size_t i = 0; i < count; ++i) {
    double done = -1.0;
    for (;;) { /* the next along the cell */
      double next = 2.0, value = 0.0, rgb[3], place[3], g[3];
      int of = 0;
      for (int c = 0; c < s->count; ++c) {
        const tetra_stretch* cut = met[i].of + c;
        for (int n = 0; n < o->contour_count; ++n) {
          const double contour = o->contours[n], t = (contour - cut->first) / (cut->last - cut->first);
          if ((cut->first < contour) != (cut->last < contour) && t > done && t < next) {
            next = t;
            value = contour;
            of = c;
          }
        }
      }
      if (next > 1.0) {
        break;
      }
      color_of(s->transfers + of, value, rgb);
      for (int a = 0; a < 3; ++a) {
        place[a] = origin[a] + (met[i].of[0].from + next * (met[i].of[0].to - met[i].of[0].from)) * along[a];
      }
      if (o->materials ? o->materials[of].shade : o->shade) {
        tetra_gradient_at(s->part + of, spaces_now.world + of, spaces_now.world + of, met[i].cell, place, g);
        tetra_illuminate(s->part + of, place, along, g, rgb);
      }
      const double alpha = opacity_of(s, of, value);
      for (int k = 0; k < 3; ++k) {
        out[k] += (1.0 - out[3]) * alpha * rgb[k];
      }
      out[3] += (1.0 - out[3]) * alpha;
      done = next;
    }
  }
}

/* Adds the first place at which any component of a weight shows, in steps. */
static void add_hit(const several* s, const met_cell* met, size_t count, const double origin[3], const double along[3], double out[4])
{
  (void)origin;
  (void)along;
  for (size_t i = 0; i < count; ++i) {
    for (int step = 0; step <= 10 * STEPS; ++step) {
      for (int c = 0; c < s->count; ++c) {
        const tetra_stretch* cut = met[i].of + c;
        const double value = cut->first + step * (cut->last - cut->first) / (10 * STEPS);
        if (opacity_of(s, c, value) > 0.0) {
          color_of(s->transfers + c, value, out);
          out[3] = 1.0;
          return;
        }
      }
    }
  }
}

/* Surfaces are exact. A ray that grazes the border of the values that show may hit another cell, as in test_tetra_first_hit. */
static void surfaces_of_components_are_right(void** state)
{
  for (uint32_t seed = 0; seed < 16; seed += few_run() ? 5 : 1) {
    several s;
    double largest;
    stratus_tetra_options* o = &s.whole.options;
    const bool hits = seed % 2 == 1, bytes = seed % 5 == 2;
    create(&s, 3, 2 + (int)(seed / 2) % 3, bytes, seed);
    o->mode = hits ? STRATUS_TETRA_FIRST_HIT : STRATUS_TETRA_ISOSURFACE;
    o->contour_count = 3;
    memcpy(o->contours, (const double[3]){ 0.7, 0.35, 0.55 }, 3 * sizeof(double));
    for (int n = 0; n < 3 && bytes; ++n) {
      o->contours[n] *= 255.0;
    }
    s.transfers[1].weight = seed % 3 == 0 ? 0.0 : 0.6;
    s.whole.mesh.cell_values = hits && seed % 3 == 1;
    for (int c = 0; c < s.count; ++c) {
      s.part[c].mesh.cell_values = s.whole.mesh.cell_values;
    }
    if (!hits && seed % 8 > 3) {
      set_light(&s, seed % 8 > 5);
    }
    tetra_camera(*state, &s.whole, 3, (int)(seed % 8), seed & 1);
    draw_reference(&s, hits ? add_hit : add_surfaces);
    draw(*state, &s, &picture);
    if (hits) {
      int others = 0;
      for (int i = 0; i < TETRA_PIXELS; ++i) {
        double most = 0.0;
        for (int k = 0; k < 4; ++k) {
          most = fmax(most, fabs((double)picture.rgba[4 * i + k] - reference[4 * i + k]));
        }
        others += most > 0.01;
        for (int k = 0; k < 4 && most > 0.01; ++k) {
          picture.rgba[4 * i + k] = (float)reference[4 * i + k];
        }
      }
      assert_true(others < TETRA_PIXELS / 100);
    }
    const double error = tetra_error(picture.rgba, reference, &largest);
    if (!(error < 0.3)) {
      print_error(
        "seed %u, %d components, mode %s: %.3f of 255, at most %.2f\n", seed, s.count, stratus_tetra_mode_name(o->mode), error, largest);
    }
    assert_true(error < 0.3);
    destroy(&s);
  }
}

/* Beside components that show nothing, each is as a mesh of its own: its hits have its material and its gradients, and its surfaces, too.
 */
static void lone_components_are_as_meshes(void** state)
{
  static const double clear[2] = { 0.0, 0.0 };
  for (int turn = 0; turn < 24; ++turn) {
    several s;
    double most = 0.0;
    const int shown = turn % 3;
    create(&s, 4, 3, false, 4);
    set_light(&s, 1);
    s.materials[2] = (stratus_material){ 1, 0.3, 0.6, 0.2, 8.0 };
    stratus_tetra_options* o = &s.whole.options;
    o->mode = turn % 6 < 3 ? STRATUS_TETRA_FIRST_HIT : STRATUS_TETRA_ISOSURFACE;
    o->normals = turn < 12 ? STRATUS_NORMALS_GRADIENT : STRATUS_NORMALS_FACES;
    o->contour_count = 1;
    o->contours[0] = 0.6;
    s.transfers[shown].weight = 1.0;
    tetra_camera(*state, &s.whole, 4, turn % 8, turn & 1);
    tetra_case one = s.part[shown];
    one.camera = s.whole.camera;
    one.options = *o;
    one.options.materials = NULL;
    one.options.shade = 1;
    one.options.shading.ambient = s.materials[shown].ambient;
    one.options.shading.diffuse = s.materials[shown].diffuse;
    one.options.shading.specular = s.materials[shown].specular;
    one.options.shading.specular_power = s.materials[shown].specular_power;
    one.mesh.values = one.values;
    one.mesh.type = STRATUS_FLOAT32;
    one.mesh.components = 1;
    one.mesh.value_stride = 1;
    one.transfer = s.transfers[shown];
    for (int c = 0; c < 3; ++c) {
      s.transfers[c].opacity = c == shown ? s.transfers[c].opacity : clear;
      s.transfers[c].opacity_count = c == shown ? s.transfers[c].opacity_count : 1;
    }
    draw(*state, &s, &picture);
    tetra_draw(*state, &one, &other);
    int others = 0, lit = 0;
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      most = 0.0;
      for (int k = 0; k < 4; ++k) {
        most = fmax(most, fabs((double)picture.rgba[4 * i + k] - (double)other.rgba[4 * i + k]));
      }
      others += most > 2e-3; /* tables that span other values round to other entries */
      lit += other.rgba[4 * i + 3] > 0.0f;
    }
    if (others > lit / 100) {
      print_error("turn %d: %d of %d pixels differ\n", turn, others, lit);
    }
    assert_true(lit > TETRA_PIXELS / 16 && others <= lit / 100);
    destroy(&s);
  }
}

/* One caster draws one mode after the other, with other functions and values: nothing of an earlier picture stays. */
static void modes_follow_one_another(void** state)
{
  static const stratus_tetra_mode modes[8] = { STRATUS_TETRA_MAXIMUM, STRATUS_TETRA_COMPOSITE, STRATUS_TETRA_FIRST_HIT,
    STRATUS_TETRA_ADDITIVE, STRATUS_TETRA_ISOSURFACE, STRATUS_TETRA_COMPOSITE, STRATUS_TETRA_MAXIMUM, STRATUS_TETRA_AVERAGE };
  stratus_tetra_caster* caster = NULL;
  several s;
  create(&s, 3, 3, false, 5);
  tetra_camera(*state, &s.whole, 3, 2, 0);
  const stratus_image image = {
    .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = other.rgba, .depth = other.depth, .rgba8 = other.rgba8
  };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int step = 0; step < 12; ++step) {
    s.whole.options.mode = modes[step % 8];
    s.whole.options.contour_count = 1;
    s.whole.options.contours[0] = 0.5;
    s.opacity[2][1] = 0.01 * step;
    if (step == 7) {
      ((float*)s.all)[3 * 20 + 2] = 0.05f;
      ++s.whole.mesh.revision;
    }
    draw(*state, &s, &picture);
    assert_int_equal(
      stratus_tetra_caster_render(caster, &s.whole.mesh, s.transfers, &s.whole.camera, &s.whole.options, &image, &other.report),
      STRATUS_OK);
    assert_memory_equal(picture.rgba, other.rgba, 4 * (size_t)TETRA_PIXELS * sizeof *picture.rgba);
    assert_memory_equal(picture.depth, other.depth, (size_t)TETRA_PIXELS * sizeof *picture.depth);
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      assert_int_equal(other.rgba8[i], (int)((double)other.rgba[i] * 255.0 + 0.5));
    }
  }
  assert_int_equal(other.report.mesh_builds, 1);
  assert_int_equal(other.report.value_builds, 2);
  const uint64_t tables = other.report.table_builds;
  assert_int_equal(
    stratus_tetra_caster_render(caster, &s.whole.mesh, s.transfers, &s.whole.camera, &s.whole.options, &image, &other.report), STRATUS_OK);
  assert_int_equal(other.report.table_builds, tables); /* another view of the same rebuilds nothing */
  stratus_tetra_caster_destroy(caster);
  destroy(&s);
}

static void lattices_threads_and_sets_agree(void** state)
{
  stratus_context* context = *state;
  for (uint32_t seed = 1; seed < 8; seed += few_run() ? 3 : 1) {
    several s;
    create(&s, 4, seed == 4 ? 4 : 2, seed == 4, seed == 3 || seed == 6 ? 5 : seed);
    s.whole.options.dependent = seed == 3 || seed == 4;
    if (seed < 3) {
      set_light(&s, seed == 2);
      set_thin(&s, 1.0);
    }
    s.whole.options.mode = seed < 5 ? STRATUS_TETRA_COMPOSITE : seed == 5 ? STRATUS_TETRA_AVERAGE : STRATUS_TETRA_MINIMUM;
    tetra_camera(context, &s.whole, 4, (int)seed, seed & 1);
    draw(context, &s, &picture);
    const int threads = context->threads, isa = context->isa;
    context->threads = threads + 1;
    for (context->isa = isa - 1; context->isa >= 0; --context->isa) {
      draw(context, &s, &other);
      assert_memory_equal(picture.rgba, other.rgba, 4 * (size_t)TETRA_PIXELS * sizeof *picture.rgba);
      assert_memory_equal(picture.depth, other.depth, (size_t)TETRA_PIXELS * sizeof *picture.depth);
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
  static const char* const words[] = { "components 5 outside 1..4", "must be at least its 3 components", "cannot be projected",
    "dependent components", "material of component 1 has (0.4, nan", "ambient is nan" };
  stratus_tetra_caster* caster = NULL;
  several s;
  create(&s, 2, 2, false, 1);
  tetra_camera(*state, &s.whole, 2, 1, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int wrong = 0; wrong < 6; ++wrong) {
    stratus_mesh mesh = s.whole.mesh;
    stratus_tetra_options o = s.whole.options;
    stratus_transfer transfers[2] = { s.transfers[0], s.transfers[1] };
    o.method = wrong == 2 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_AUTO;
    mesh.components = wrong == 0 ? 5 : wrong == 1 || wrong == 3 ? 3 : 2;
    mesh.value_stride = wrong == 3 ? 3 : 2;
    mesh.point_count = wrong == 3 ? 0 : mesh.point_count;
    mesh.cell_count = wrong == 3 ? 0 : mesh.cell_count;
    o.dependent = wrong == 3;
    if (wrong == 4 || wrong == 5) {
      set_light(&s, wrong == 4);
      o = s.whole.options;
      s.materials[1].diffuse = NAN;
      o.shading.ambient = wrong == 5 ? (double)NAN : 0.1;
    }
    assert_int_equal(stratus_tetra_caster_render(caster, &mesh, transfers, &s.whole.camera, &o, &image, NULL),
      wrong < 2 || wrong > 3 ? STRATUS_INVALID_ARGUMENT : STRATUS_UNSUPPORTED);
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
    cmocka_unit_test_setup_teardown(lit_components_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(modes_of_components_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(surfaces_of_components_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(lone_components_are_as_meshes, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(dependent_components_in_all_modes, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(modes_follow_one_another, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(halves_are_a_whole, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(lattices_threads_and_sets_agree, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_components_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
