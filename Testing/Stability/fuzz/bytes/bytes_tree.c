/* SPDX-License-Identifier: BSD-3-Clause
 * Saved trees: the input is a tree's bytes, or edits of a tree that is built here. A tree that is accepted must be safe to use, and is
 * saved as the same bytes. */
#include "bytes.h"
#include "stratus.h"
#include "tree.h"

#include <math.h>
#include <string.h>

#define MEND 1  /* flag: length and checksum are put right */
#define EDITS 2 /* flag: edits of five bytes (place, place, kind, value, value), not a tree */
#define RAYS 24

static stratus_context* context;

/* A tree of few voxels, whose shape and method follow from the byte. */
static unsigned char* make_saved(uint8_t which, size_t* size)
{
  int32_t at[3 * 64];
  const int64_t n[3] = { 5 + which % 3 * 20, 9, 12 };
  const size_t count = 1 + (size_t)which / 16 * 4;
  for (size_t i = 0; i < count; ++i) {
    at[3 * i] = (int32_t)(i * 7 % (size_t)n[0]);
    at[3 * i + 1] = (int32_t)(which & 1 ? i / 8 : i * 5 % 9);
    at[3 * i + 2] = (int32_t)(i % 12);
  }
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  stratus_tree_options options = stratus_tree_options_default();
  options.method = (stratus_tree_method)(which % STRATUS_TREE_METHODS);
  options.leaf_bricks = 1 + which % 5;
  HOLDS(stratus_voxels_create_list(context, n, at, count, &voxels) == STRATUS_OK, "%s", stratus_context_message(context));
  HOLDS(stratus_tree_create(context, voxels, &options, &tree) == STRATUS_OK, "%s", stratus_context_message(context));
  *size = stratus_tree_bytes(tree);
  unsigned char* bytes = malloc(*size);
  stratus_tree_save(tree, bytes);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  return bytes;
}

static void edit(unsigned char* bytes, size_t* size, const uint8_t* e)
{
  const size_t at = (size_t)(e[0] | e[1] << 8) % *size;
  const uint32_t value = (uint32_t)(e[3] | e[4] << 8);
  switch (e[2] % 6) {
    case 0:
      bytes[at] = e[3];
      break;
    case 1:
      bytes[at] ^= (unsigned char)(1u << e[3] % 8);
      break;
    case 2:
      if (at / 4 * 4 + 4 <= *size) {
        memcpy(bytes + at / 4 * 4, &value, 4);
      }
      break;
    case 3:
      if (at / 4 * 4 + 4 <= *size) {
        const uint32_t great = 0u - value;
        memcpy(bytes + at / 4 * 4, &great, 4);
      }
      break;
    case 4:
      memmove(bytes + at, bytes + value % *size, at + 16 <= *size && value % *size + 16 <= *size ? 16 : 1);
      break;
    default:
      *size = at > 0 && e[3] == 77 ? at : *size; /* cut short, rarely */
      break;
  }
}

static void use(const stratus_tree* tree)
{
  stratus_tree_statistics s;
  stratus_ray rays[RAYS];
  stratus_hit hits[RAYS];
  stratus_tree_get_statistics(tree, &s);
  HOLDS(s.nodes >= 0 && s.nodes < 1000000 && memchr(s.why, '\0', sizeof s.why), "%lld nodes are let in", (long long)s.nodes);
  stratus_node_box* boxes = malloc((size_t)s.nodes * sizeof *boxes + 1);
  stratus_tree_boxes(tree, boxes);
  free(boxes);
  for (int i = 0; i < RAYS; ++i) {
    const double a = 0.7 * i, b = 0.31 * i;
    rays[i] = (stratus_ray){ .origin = { 20 + 40 * cos(a), 5 + 30 * sin(a), 6 + 20 * sin(b) }, .t_max = INFINITY };
    rays[i].direction[0] = i % 4 == 0 ? 0.0 : 20 + i - rays[i].origin[0];
    rays[i].direction[1] = 4 + i % 5 - rays[i].origin[1];
    rays[i].direction[2] = i % 3 == 0 ? 0.0 : 6 - rays[i].origin[2];
  }
  (void)stratus_tree_first_hit(context, tree, rays, RAYS, hits);
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  if (!context) {
    stratus_context_options options = stratus_context_options_default();
    options.device = "host";
    options.threads = 1;
    HOLDS(stratus_context_create(&options, &context, NULL, 0) == STRATUS_OK, "no context");
  }
  if (size < 2) {
    return 0;
  }
  const uint8_t flags = data[0];
  unsigned char* bytes;
  size_t length = size - 1;
  if (flags & EDITS) {
    bytes = make_saved(data[1], &length);
    for (size_t e = 2; e + 5 <= size; e += 5) {
      edit(bytes, &length, data + e);
    }
  } else {
    bytes = malloc(length);
    memcpy(bytes, data + 1, length);
  }
  if (flags & MEND && length > 24) {
    stratus_tree_seal(bytes, length);
  }
  unsigned char* exact = malloc(length); /* a cut must end where the address sanitizer sees it */
  memcpy(exact, bytes, length);
  free(bytes);
  stratus_tree *tree = NULL, *again = NULL;
  if (stratus_tree_load(context, exact, length, &tree) == STRATUS_OK) {
    use(tree);
    const size_t saved = stratus_tree_bytes(tree);
    HOLDS(saved == length, "%zu bytes are loaded, %zu saved", length, saved);
    unsigned char* back = malloc(saved);
    stratus_tree_save(tree, back);
    HOLDS(
      stratus_tree_load(context, back, saved, &again) == STRATUS_OK, "saved again, it is refused: %s", stratus_context_message(context));
    free(back);
  } else {
    HOLDS(strlen(stratus_context_message(context)) > 3, "refused without a message");
  }
  stratus_tree_destroy(tree);
  stratus_tree_destroy(again);
  free(exact);
  return 0;
}
