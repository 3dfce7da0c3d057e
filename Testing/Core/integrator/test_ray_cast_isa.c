/* SPDX-License-Identifier: BSD-3-Clause
 * One source, many widths: AVX-512, AVX2 and the baseline give the same bits, whatever the width of their packets. The counts of
 * samples may differ: a packet looks the structure up once enough of its rays need it. */
#include "stratus.h"

#include "several_case.h"

#include "volume.h"
#include "ray_cast_host.h"
#include "testing.h"

static picture best;
static picture other;

static void every_instruction_set_gives_the_same_bits(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  const int best_isa = stratus_isa_highest();
  int lit = 0;
  for (uint32_t seed = 700; seed < 760; ++seed) {
    picture_case c;
    case_create_random(context, seed, &c);
    context->isa = best_isa;
    case_render(context, &c, &best);
    lit += case_lit(&best) > 0;
    for (int isa = 0; isa < best_isa; ++isa) {
      context->isa = isa;
      case_render(context, &c, &other);
      if (memcmp(best.rgba, other.rgba, sizeof best.rgba) || memcmp(best.depth, other.depth, sizeof best.depth)) {
        int differing = 0;
        for (int i = 0; i < CASE_PIXELS; ++i) {
          differing += memcmp(best.rgba + 4 * i, other.rgba + 4 * i, 4 * sizeof(float)) != 0;
        }
        print_error("seed %u, instruction set %d: %d of %d pixels differ\n", seed, isa, differing, CASE_PIXELS);
        fail();
      }
    }
    case_destroy(&c);
  }
  assert_true(lit > 30);
  stratus_context_destroy(context);
}

static void every_instruction_set_mixes_several_volumes_alike(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  const int best_isa = stratus_isa_highest();
  for (uint32_t seed = 0; seed < 20; ++seed) {
    several_case m;
    several_create(context, &m, 2 + (int)(seed % 4), 500 + seed);
    m.of[1].options.sampling.distance = 0.9;
    m.of[0].options.sampling.jitter = seed % 3 == 0;
    m.of[1].options.light.shade = seed % 2 == 0;
    context->isa = best_isa;
    several_draw(context, &m, &best);
    assert_true(case_lit(&best) > case_share(100));
    for (int isa = 0; isa < best_isa; ++isa) {
      context->isa = isa;
      several_draw(context, &m, &other);
      assert_memory_equal(best.rgba, other.rgba, sizeof best.rgba);
      assert_memory_equal(best.depth, other.depth, sizeof best.depth);
    }
    several_destroy(&m);
  }
  stratus_context_destroy(context);
}

int test_ray_cast_isa(void)
{
  if (stratus_isa_highest() == 0) {
    return test_skip("the baseline is the only instruction set here");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_instruction_set_gives_the_same_bits),
    cmocka_unit_test(every_instruction_set_mixes_several_volumes_alike),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
