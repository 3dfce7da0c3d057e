/* SPDX-License-Identifier: BSD-3-Clause
 * The choice of functions for an instruction set. */
#include "first_hit_batch.h"

const stratus_hit_functions* stratus_hit_functions_for(const stratus_context* context)
{
  static const stratus_hit_functions* const functions[] = STRATUS_ISA_EACH(&stratus_hit_functions);
  return functions[stratus_isa_at_most(context->isa)];
}
