/* SPDX-License-Identifier: BSD-3-Clause
 * The path tracer where light scatters many times: Chandrasekhar's H function, slabs by adding and doubling, and the conservation of
 * energy.
 */
#include "path_case.h"

#define PI 3.141592653589793
#define NODES 32 /* of the quadrature over the cosine, on each side */
#define EXTRA 4  /* cosines of suns and views, of a weight that counts as none */
#define ALL (NODES + EXTRA)
#define NO_WEIGHT 1e-12
#define DOUBLINGS 34

static double cosines[ALL], weights[ALL];

/* Gauss and Legendre's nodes on 0..1, by Newton's method. */
static void set_nodes(int count, double* nodes, double* of)
{
  for (int i = 0; i < count; ++i) {
    double x = cos(PI * (i + 0.75) / (count + 0.5)), slope = 1.0;
    for (int step = 0; step < 100; ++step) {
      double p = 1.0, before = 0.0;
      for (int k = 1; k <= count; ++k) {
        const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k;
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    nodes[i] = 0.5 * (1.0 - x);
    of[i] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
}

/* ---- adding and doubling (van de Hulst 1963), of radiance that is even about the normal */

typedef struct layer {
  double r[ALL][ALL], t[ALL][ALL];
} layer;

/* The mean over the azimuth of 4 pi times the phase function. */
static double mean_phase(double g, double a, double b)
{
  double sum = 0.0;
  for (int i = 0; i < 96; ++i) {
    const double cosine = a * b + sqrt((1.0 - a * a) * (1.0 - b * b)) * cos(2.0 * PI * (i + 0.5) / 96.0);
    sum += (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5) / 96.0;
  }
  return sum;
}

/* Result = a b. */
static void multiply(double a[ALL][ALL], double b[ALL][ALL], double result[ALL][ALL])
{
  for (int i = 0; i < ALL; ++i) {
    for (int j = 0; j < ALL; ++j) {
      double sum = 0.0;
      for (int k = 0; k < ALL; ++k) {
        sum += a[i][k] * b[k][j];
      }
      result[i][j] = sum;
    }
  }
}

/* Inverse of 1 - a, whose sums of rows are below 1, by Gauss and Jordan's method. a is lost. */
static void invert_rest(double a[ALL][ALL], double inverse[ALL][ALL])
{
  for (int i = 0; i < ALL; ++i) {
    for (int j = 0; j < ALL; ++j) {
      a[i][j] = (i == j) - a[i][j];
      inverse[i][j] = i == j;
    }
  }
  for (int i = 0; i < ALL; ++i) {
    const double pivot = a[i][i];
    for (int j = 0; j < ALL; ++j) {
      a[i][j] /= pivot;
      inverse[i][j] /= pivot;
    }
    for (int row = 0; row < ALL; ++row) {
      const double part = a[row][i];
      for (int j = 0; row != i && j < ALL; ++j) {
        a[row][j] -= part * a[i][j];
        inverse[row][j] -= part * inverse[i][j];
      }
    }
  }
}

/* Gives the radiance out of a slab at cosine i for radiance into it at cosine j, weights included. */
static void double_layers(double tau, double albedo, double g, layer* whole)
{
  static double forwards[ALL][ALL], backwards[ALL][ALL], rr[ALL][ALL], between[ALL][ALL], tb[ALL][ALL], rt[ALL][ALL];
  const double thin = ldexp(tau, -DOUBLINGS);
  for (int j = 0; j < ALL; ++j) {
    double sum = 0.0;
    for (int i = 0; i < ALL; ++i) {
      forwards[i][j] = mean_phase(g, cosines[i], cosines[j]);
      backwards[i][j] = mean_phase(g, cosines[i], -cosines[j]);
      sum += 0.5 * weights[i] * (forwards[i][j] + backwards[i][j]);
    }
    for (int i = 0; i < ALL; ++i) { /* of the light that scatters, the quadrature loses none */
      const double single = 0.5 * albedo * weights[j] * thin / cosines[i] / sum;
      whole->r[i][j] = single * backwards[i][j];
      whole->t[i][j] = single * forwards[i][j] + (i == j ? exp(-thin / cosines[i]) : 0.0);
    }
  }
  for (int doubling = 0; doubling < DOUBLINGS; ++doubling) {
    multiply(whole->r, whole->r, rr);
    invert_rest(rr, between);
    multiply(whole->t, between, tb);
    multiply(whole->r, whole->t, rt);
    multiply(tb, rt, rr);
    multiply(tb, whole->t, rt);
    for (int i = 0; i < ALL; ++i) {
      for (int j = 0; j < ALL; ++j) {
        whole->r[i][j] += rr[i][j];
        whole->t[i][j] = rt[i][j];
      }
    }
  }
}

/* Radiance that leaves at the extra cosine `view` for a sun of colour 1, an irradiance of 4 pi, at another one, without the sun's own. */
static double of_sun(double out[ALL][ALL], int view, int sun)
{
  return out[NODES + view][NODES + sun] / NO_WEIGHT * 2.0;
}

/* The same for a sky whose radiance is the cosine to the normal on one side, and 0 on the other. The sky itself, which only the view's own
 * cosine passes, is left out. */
static double of_sky(double out[ALL][ALL], int view)
{
  double sum = 0.0;
  for (int j = 0; j < NODES; ++j) {
    sum += out[NODES + view][j] * cosines[j];
  }
  return sum;
}

/* ---- Chandrasekhar 1950 */

/* Iterates 1/H(m) = sqrt(1 - w) + w/2 integral of m' H(m') / (m + m') dm', and returns H at one cosine. */
static double chandrasekhar(double albedo, double cosine)
{
  double nodes[64], of[64], h[65], next[65];
  set_nodes(64, nodes, of);
  for (int i = 0; i < 65; ++i) {
    h[i] = 1.0;
  }
  for (double change = 1.0; change > 1e-12;) {
    change = 0.0;
    for (int i = 0; i < 65; ++i) {
      const double m = i < 64 ? nodes[i] : cosine;
      double sum = 0.0;
      for (int j = 0; j < 64; ++j) {
        sum += of[j] * nodes[j] * h[j] / (m + nodes[j]);
      }
      next[i] = 1.0 / (sqrt(1.0 - albedo) + 0.5 * albedo * sum);
    }
    for (int i = 0; i < 65; ++i) { /* the mean of two steps, which swing about the solution */
      change = fmax(change, fabs(next[i] - h[i]));
      h[i] = 0.5 * (h[i] + next[i]);
    }
  }
  return h[64];
}

static int begin(void** state)
{
  static const double extra[EXTRA] = { 0.3, 0.8, 0.5, 1.0 };
  set_nodes(NODES, cosines, weights);
  for (int i = 0; i < EXTRA; ++i) {
    cosines[NODES + i] = extra[i];
    weights[NODES + i] = NO_WEIGHT;
  }
  return case_set_up(state);
}

/* ---- the tests */

/* The two independent methods agree with each other, with energy, and with a table. */
static void the_judges_agree(void** state)
{
  static layer slab;
  (void)state;
  double_layers(60.0, 0.9, 0.0, &slab);
  const double h[2] = { chandrasekhar(0.9, 1.0), chandrasekhar(0.9, 0.3) }, expected = 0.9 * 0.3 / 1.3 * h[0] * h[1];
  print_message("             H(1) %.6f for albedo .9; reflection %.8f by H, %.8f by doubling\n", h[0], expected, of_sun(slab.r, 3, 0));
  assert_true(fabs(of_sun(slab.r, 3, 0) - expected) < 1e-5);
  assert_true(fabs(chandrasekhar(1.0, 1.0) - 2.9078) < 1e-4); /* Chandrasekhar 1950, table XI */
  for (int g = 0; g < 2; ++g) {
    double_layers(2.0, 1.0, 0.6 * g, &slab);
    for (int j = 0; j < NODES; ++j) {
      double in = 0.0;
      for (int i = 0; i < NODES; ++i) {
        in += weights[i] * cosines[i] * (slab.r[i][j] + slab.t[i][j]);
      }
      assert_true(fabs(in / (weights[j] * cosines[j]) - 1.0) < 1e-6);
    }
  }
}

static void a_half_space_reflects_as_chandrasekhar_says(void** state)
{
  static const double albedos[] = { 0.5, 0.9, 0.98 }, suns[] = { 1.0, 0.5, 0.1 };
  char what[96];
  for (int a = 0; a < 3; ++a) {
    for (int s = 0; s < 3; ++s) {
      path_case c;
      const double direction[3] = { 0.4, 0.9, -1.0 }, mu = 1.0 / sqrt(1.97);
      path_slab(*state, &c, 80.0, 1.0, 2);
      path_look(*state, &c, direction, (double[3]){ 0, 0, 0.5 }, 10.0);
      path_sun(&c, suns[s]);
      c.options.albedo = albedos[a];
      c.options.seed = (uint64_t)(3 * a + s);
      c.options.samples = path_samples(250);
      const double expected = albedos[a] * suns[s] / (suns[s] + mu) * chandrasekhar(albedos[a], mu) * chandrasekhar(albedos[a], suns[s]);
      const path_mean mean = path_draw(*state, &c);
      snprintf(what, sizeof what, "half space, albedo %.2f, sun %.1f", albedos[a], suns[s]);
      path_assert(what, expected, mean.rgba[0], mean.error[0], 0.02);
    }
  }
}

static const struct {
  double tau, albedo, g;
} slabs[] = { { 0.5, 1.0, 0.0 }, { 2.0, 0.8, 0.0 }, { 8.0, 1.0, 0.0 }, { 2.0, 0.95, 0.6 }, { 1.0, 1.0, -0.4 } };

/* A sun, seen from straight above and below, and a sky, seen at a slant. */
static void slabs_reflect_and_transmit_as_by_doubling(void** state)
{
  static layer slab;
  char what[96];
  for (size_t n = 0; n < sizeof slabs / sizeof *slabs; ++n) {
    double_layers(slabs[n].tau, slabs[n].albedo, slabs[n].g, &slab);
    for (int from = 0; from < 2; ++from) { /* 1: transmitted */
      for (int sun = 0; sun < 3; ++sun) {  /* the last one is a sky */
        const double look = from ? 1.0 : -1.0, slant[3] = { 0.6 * cos(1.0), 0.6 * sin(1.0), 0.8 * look };
        path_case c;
        path_slab(*state, &c, slabs[n].tau, 1.0, 6);
        path_look(*state, &c, sun == 2 ? slant : (double[3]){ 0, 0, look }, (double[3]){ 0, 0, 0.5 }, 10.0);
        c.options.albedo = slabs[n].albedo;
        c.options.anisotropy = slabs[n].g;
        c.options.samples = path_samples(250);
        c.options.seed = (uint64_t)(6 * n) + (uint64_t)(3 * from + sun);
        double expected = of_sky(from ? slab.t : slab.r, 1);
        if (sun < 2) {
          path_sun(&c, cosines[NODES + sun]);
          expected = of_sun(from ? slab.t : slab.r, 3, sun);
        } else {
          c.options.sky_zenith[0] = 1.0;
          c.options.up[2] = 7.0;
        }
        const path_mean mean = path_draw(*state, &c);
        snprintf(what, sizeof what, "tau %.1f albedo %.2f g %.1f %s%s %.1f", slabs[n].tau, slabs[n].albedo, slabs[n].g,
          from ? "below a " : "above a ", sun < 2 ? "sun" : "sky,", sun < 2 ? cosines[NODES + sun] : 0.8);
        path_assert(what, expected, mean.rgba[0], mean.error[0], 0.05);
      }
    }
  }
}

/* The orders of scattering are the coefficients of the radiance as a power series in the albedo, here by differences. */
static void bounces_limit_the_number_of_scatterings(void** state)
{
  static layer slab;
  const double step = 1e-3;
  double up, down;
  path_case c;
  double_layers(2.0, step, 0.0, &slab);
  up = of_sun(slab.r, 3, 1) / step;
  double_layers(2.0, -step, 0.0, &slab);
  down = of_sun(slab.r, 3, 1) / -step;
  path_slab(*state, &c, 2.0, 1.0, 3);
  path_sun(&c, 0.8);
  c.options.samples = path_samples(1500);
  for (int bounces = 1; bounces <= 2; ++bounces) {
    c.options.bounces = bounces;
    const path_mean mean = path_draw(*state, &c);
    path_assert(bounces == 1 ? "1 bounce" : "2 bounces", 0.5 * (up + down) + (bounces - 1) * (up - down) / (2.0 * step), mean.rgba[0],
      mean.error[0], 0.01);
  }
  const stratus_light none = { .vector = { 0, 0, 1 } };
  c.options.lights[0] = none;
  c.options.sky_zenith[0] = c.options.sky_horizon[0] = 1.0;
  c.options.bounces = 1; /* the sky is what a path sees behind its last scattering */
  double expected = 0.0; /* integral over the depth of exp(-t) (E2(t) + E2(2 - t)) / 2 */
  for (int i = 0; i < 4000; ++i) {
    const double t = 2.0 * (i + 0.5) / 4000.0;
    double seen = 0.0;
    for (int j = 0; j < NODES; ++j) {
      seen += 0.5 * weights[j] * (exp(-t / cosines[j]) + exp(-(2.0 - t) / cosines[j]));
    }
    expected += exp(-t) * seen * 2.0 / 4000.0;
  }
  const path_mean mean = path_draw(*state, &c);
  path_assert("1 bounce under a sky", expected, mean.rgba[0], mean.error[0], 0.01);
}

/* Light scattered into all directions and light that passes straight are all the light of the sun, if nothing is absorbed. */
static void no_light_is_lost(void** state)
{
  enum { VIEWS = 12 };
  double views[VIEWS], of[VIEWS], sum, square = 0.0;
  const double sun = 0.6, tau = 1.5;
  path_case c;
  set_nodes(VIEWS, views, of);
  sum = exp(-tau / sun) * sun * 4.0 * PI;
  for (int v = 0; v < 2 * VIEWS; ++v) {
    const double m = views[v / 2], sine = sqrt(1.0 - m * m), weight = 2.0 * PI * of[v / 2] * m;
    path_slab(*state, &c, tau, 1.0, 2);
    path_look(*state, &c, (double[3]){ sine * cos(v), sine * sin(v), v % 2 ? m : -m }, (double[3]){ 0, 0, 0.5 }, 20.0);
    path_sun(&c, sun);
    c.options.samples = path_samples(150);
    c.options.seed = (uint64_t)v;
    const path_mean mean = path_draw(*state, &c);
    sum += weight * mean.rgba[0];
    square += weight * weight * mean.error[0] * mean.error[0];
  }
  path_assert("light in all directions", sun * 4.0 * PI, sum, sqrt(square), 0.01);
}

int test_path_multiple(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(the_judges_agree), cmocka_unit_test(a_half_space_reflects_as_chandrasekhar_says),
    cmocka_unit_test(slabs_reflect_and_transmit_as_by_doubling), cmocka_unit_test(bounces_limit_the_number_of_scatterings),
    cmocka_unit_test(no_light_is_lost) };
  return cmocka_run_group_tests(tests, begin, case_tear_down);
}
