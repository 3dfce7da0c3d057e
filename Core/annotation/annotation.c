/* SPDX-License-Identifier: BSD-3-Clause
 * Draws a picture's annotations in the order in which they cover each other. */
#include "stratus/annotation.h"

#include "axis_ticks.h"
#include "box.h"
#include "camera.h"
#include "layout.h"
#include "sheet.h"

#include <string.h>

#define MOST_LONGITUDE 3600.0 /* degrees: lines are drawn anew in each turn */

stratus_annotation stratus_annotation_default(void)
{
  stratus_annotation annotation;
  memset(&annotation, 0, sizeof annotation);
  for (int a = 0; a < 3; ++a) {
    annotation.axis[a] = stratus_axis_default();
  }
  annotation.ink = 0.9;
  return annotation;
}

static stratus_status check_bar(stratus_context* context, const stratus_annotation* a)
{
  if (!isfinite(a->low) || !isfinite(a->high) || a->low > a->high || (a->logarithmic && !(a->low > 0.0))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a colour bar from %g to %g, must be finite, ascending%s", a->low, a->high,
      a->logarithmic ? ", and above 0 by logarithms" : "");
  }
  for (size_t i = 0; i < 4 * a->color_count; ++i) {
    if (!isfinite(a->color[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "point %zu of the colour bar is not finite", i / 4);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_coast(stratus_context* context, const stratus_annotation* a)
{
  if (!(a->globe >= 0.0) || !isfinite(a->globe)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a globe of radius %g, must be 0 or more and finite", a->globe);
  }
  if (a->globe > 0.0 || a->coast_place) {
    return STRATUS_OK;
  }
  if (stratus_coast_face(a) < 0) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "coastlines need an axis of longitudes and one of latitudes, or the places of a projection");
  }
  for (int side = 0; side < 6; ++side) {
    const stratus_axis* const axis = &a->axis[side / 2];
    const double degrees = a->bounds[side] * axis->scale;
    if (axis->kind == STRATUS_AXIS_LONGITUDE && !(fabs(degrees) <= MOST_LONGITUDE)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "coastlines at longitude %g degrees, must be in -%g..%g", degrees,
        MOST_LONGITUDE, MOST_LONGITUDE);
    }
  }
  return STRATUS_OK;
}

static stratus_status check(stratus_context* context, const stratus_annotation* a, int width, int height)
{
  if (!a) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "annotation is NULL");
  }
  if (width < 1 || height < 1 || width > 65536 || height > 65536) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a picture of %dx%d pixels, each side must be 1..65536", width, height);
  }
  if (!(a->ink >= 0.0 && a->ink <= 1.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "ink %g, must be 0..1", a->ink);
  }
  if (stratus_layout_has_bar(a)) {
    TRY(check_bar(context, a));
  }
  for (int axis = 0; axis < 3 && (a->axes || (a->coast && !(a->globe > 0.0))); ++axis) {
    const double low = a->bounds[2 * axis], high = a->bounds[2 * axis + 1];
    if (!isfinite(low) || !isfinite(high) || low > high) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "bounds along axis %d are %g to %g, must be finite and ascending", axis, low, high);
    }
    TRY(stratus_axis_check(context, &a->axis[axis]));
  }
  return a->coast ? check_coast(context, a) : STRATUS_OK;
}

stratus_status stratus_annotation_room(
  stratus_context* context, const stratus_annotation* annotation, int width, int height, double room[4])
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!room) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "room is NULL");
  }
  TRY(check(context, annotation, width, height));
  stratus_layout layout;
  TRY(stratus_layout_make(context, annotation, width, height, &layout));
  memcpy(room, layout.room, sizeof layout.room);
  return STRATUS_OK;
}

stratus_status stratus_camera_in_room(
  stratus_context* context, const stratus_camera* part, int width, int height, const double room[4], stratus_camera* whole)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!part || !room || !whole) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "part, room or whole is NULL");
  }
  if (width < 1 || height < 1 || !(room[0] < room[1]) || !(room[2] < room[3])) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a room of %g..%g x %g..%g pixels in a picture of %dx%d", room[0], room[1],
      room[2], room[3], width, height);
  }
  const double half[2] = { (room[1] - room[0]) / width, (room[3] - room[2]) / height };
  const double middle[2] = { (room[0] + room[1]) / width - 1.0, (room[2] + room[3]) / height - 1.0 };
  stratus_camera made = *part;
  double* const moved = part->parallel ? made.eye : made.forward;
  for (int a = 0; a < 3; ++a) {
    made.right[a] = part->right[a] / half[0];
    made.up[a] = part->up[a] / half[1];
    moved[a] -= middle[0] * made.right[a] + middle[1] * made.up[a];
  }
  *whole = made;
  return STRATUS_OK;
}

static void color_at(const stratus_annotation* a, double value, float rgb[3])
{
  size_t i = 0;
  while (i + 2 < a->color_count && a->color[4 * (i + 1)] < value) {
    ++i;
  }
  const double* const from = a->color + 4 * i;
  const double* const to = i + 1 < a->color_count ? from + 4 : from;
  const double width = to[0] - from[0], part = width > 0.0 ? fmin(fmax((value - from[0]) / width, 0.0), 1.0) : 0.0;
  for (int c = 0; c < 3; ++c) {
    rgb[c] = (float)(from[1 + c] + part * (to[1 + c] - from[1 + c]));
  }
}

static stratus_status draw_bar(stratus_sheet* sheet, const stratus_annotation* a, const stratus_layout* layout)
{
  const int right = sheet->width - layout->margin, line = stratus_line_height(layout->title_size);
  for (int j = 0; j < layout->bar_tall; ++j) {
    const double t = (j + 0.5) / layout->bar_tall;
    float rgb[3];
    color_at(a, a->logarithmic ? a->low * pow(a->high / a->low, t) : a->low + t * (a->high - a->low), rgb);
    for (int i = 0; i < layout->bar_wide; ++i) {
      stratus_sheet_put(sheet, layout->bar_left + i, layout->bar_bottom + j, 1.0f, rgb);
    }
  }
  for (int i = 0; i < layout->tick_count; ++i) {
    const double at[2] = { layout->bar_left + layout->bar_wide + floor(0.5 * layout->size),
      layout->bar_bottom + layout->tick_at[i] * (layout->bar_tall - 1) };
    TRY(stratus_sheet_write_line(sheet, layout->tick_text[i], layout->size, at, 0.0, 0.5, 3));
  }
  for (int i = 0; i < layout->title.count; ++i) {
    const double at[2] = { right, layout->bar_bottom + layout->bar_tall + 0.9 * layout->size + line * (layout->title.count - 1 - i) };
    TRY(stratus_sheet_write_line(sheet, layout->title.line[i], layout->title_size, at, 1.0, 0.0, 3));
  }
  const stratus_pixels column = { layout->bar_left - 3, layout->bar_bottom - 3, sheet->width, layout->bar_bottom + layout->bar_tall + 3 };
  return stratus_sheet_take(sheet, column);
}

static stratus_status draw_caption(stratus_sheet* sheet, const stratus_layout* layout)
{
  const int line = stratus_line_height(layout->title_size);
  for (int i = 0; i < layout->caption.count; ++i) {
    const double at[2] = { layout->margin, sheet->height - layout->margin - i * line };
    TRY(stratus_sheet_write_line(sheet, layout->caption.line[i], layout->title_size, at, 0.0, 1.0, 4));
  }
  return STRATUS_OK;
}

/* Lines behind the volume, then those in front of it, then text. */
static stratus_status draw_all(
  stratus_sheet* sheet, const stratus_annotation* a, const stratus_layout* layout, const stratus_camera* camera)
{
  bool facing[6];
  stratus_box_facing(a, camera, facing);
  for (int front = 0; front < 2; ++front) {
    if (a->coast && a->globe > 0.0) {
      if (front) {
        stratus_coast_draw_globe(sheet, a->globe);
      }
    } else if (a->coast && facing[stratus_coast_face(a)] == (front == 1)) {
      stratus_coast_draw(sheet, a);
    }
    if (a->axes) {
      TRY(stratus_box_edges(sheet, a, facing, front == 0));
    }
    if (front == 0) {
      stratus_sheet_lay(sheet, true);
    }
  }
  TRY(draw_caption(sheet, layout));
  if (stratus_layout_has_bar(a)) {
    TRY(draw_bar(sheet, a, layout));
  }
  if (a->axes) {
    TRY(stratus_box_axes(sheet, a, layout, facing));
  }
  stratus_sheet_lay(sheet, false);
  return STRATUS_OK;
}

stratus_status stratus_annotation_draw(stratus_context* context, const stratus_annotation* annotation, const stratus_camera* camera,
  const stratus_image* image, stratus_annotation_text* texts, size_t most, size_t* count)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!camera || !image || !image->rgba || (most > 0 && !texts)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera, image, its rgba or texts is NULL");
  }
  TRY(check(context, annotation, image->width, image->height));
  stratus_layout layout;
  stratus_sheet sheet;
  TRY(stratus_layout_make(context, annotation, image->width, image->height, &layout));
  TRY(stratus_sheet_create(context, camera, image, annotation->ink, layout.size, &sheet));
  sheet.texts = texts;
  sheet.most = most;
  const stratus_status status = draw_all(&sheet, annotation, &layout, camera);
  stratus_sheet_destroy(&sheet);
  if (count) {
    *count = sheet.count;
  }
  return status;
}
