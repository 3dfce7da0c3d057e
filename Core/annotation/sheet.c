/* SPDX-License-Identifier: BSD-3-Clause
 * Lines and text onto a picture. */
#include "sheet.h"

#include <stdio.h>
#include <string.h>

#define EDGE 2 /* pixels at a picture's edge that text leaves free */

static double dot(const double* a, const double* b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double* a, const double* b, double factor, double* to)
{
  for (int i = 0; i < 3; ++i) {
    to[i] = factor * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
  }
}

stratus_status stratus_sheet_create(
  stratus_context* context, const stratus_camera* camera, const stratus_image* image, double ink, double size, stratus_sheet* sheet)
{
  memset(sheet, 0, sizeof *sheet);
  sheet->context = context;
  sheet->width = image->width;
  sheet->height = image->height;
  sheet->rgba = image->rgba;
  sheet->ink = (float)ink;
  sheet->size = size;
  sheet->parallel = camera->parallel != 0;
  double normal[3];
  cross(camera->right, camera->up, 1.0, normal);
  const double whole = dot(camera->forward, normal);
  if (!isfinite(whole) || whole == 0.0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the camera's forward, right and up are in one plane");
  }
  memcpy(sheet->eye, camera->eye, sizeof sheet->eye);
  cross(camera->right, camera->up, 1.0 / whole, sheet->forward);
  cross(camera->up, camera->forward, 1.0 / whole, sheet->across);
  cross(camera->forward, camera->right, 1.0 / whole, sheet->up);
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, (size_t)sheet->width * (size_t)sheet->height, sizeof(float), &memory));
  sheet->coverage = memory;
  return STRATUS_OK;
}

void stratus_sheet_destroy(stratus_sheet* sheet)
{
  stratus_release(sheet->context, sheet->coverage);
  stratus_release(sheet->context, sheet->taken.list);
  stratus_release(sheet->context, sheet->lines.list);
}

bool stratus_sheet_project(const stratus_sheet* sheet, const double world[3], double at[2])
{
  const double d[3] = { world[0] - sheet->eye[0], world[1] - sheet->eye[1], world[2] - sheet->eye[2] };
  const double k = sheet->parallel ? 1.0 : dot(d, sheet->forward);
  at[0] = (dot(d, sheet->across) / k + 1.0) * 0.5 * sheet->width - 0.5;
  at[1] = (dot(d, sheet->up) / k + 1.0) * 0.5 * sheet->height - 0.5;
  return k > 1e-9 && isfinite(at[0]) && isfinite(at[1]);
}

void stratus_sheet_line(stratus_sheet* sheet, const double from[2], const double to[2])
{
  const double half = fmax(0.6, 0.045 * sheet->size), reach = half + 0.5;
  const double d[2] = { to[0] - from[0], to[1] - from[1] };
  const double square = fmax(d[0] * d[0] + d[1] * d[1], 1e-18);
  const int sides[2] = { sheet->width, sheet->height };
  const int along = fabs(d[0]) >= fabs(d[1]) ? 0 : 1, across = 1 - along;
  const double slope = d[along] != 0.0 ? d[across] / d[along] : 0.0, wide = reach * sqrt(1.0 + slope * slope);
  const int first = (int)fmax(floor(fmin(from[along], to[along]) - reach), 0.0),
            last = (int)fmin(ceil(fmax(from[along], to[along]) + reach), sides[along] - 1);
  for (int i = first; i <= last; ++i) {
    const double middle = from[across] + slope * (fmin(fmax(i, fmin(from[along], to[along])), fmax(from[along], to[along])) - from[along]);
    const int low = (int)fmax(floor(middle - wide), 0.0), high = (int)fmin(ceil(middle + wide), sides[across] - 1);
    for (int j = low; j <= high; ++j) {
      const double p[2] = { along == 0 ? i : j, along == 0 ? j : i };
      const double t = fmin(fmax(((p[0] - from[0]) * d[0] + (p[1] - from[1]) * d[1]) / square, 0.0), 1.0);
      const double distance = stratus_length_2(p[0] - from[0] - t * d[0], p[1] - from[1] - t * d[1]);
      float* const put = &sheet->coverage[(size_t)p[1] * (size_t)sheet->width + (size_t)p[0]];
      *put = fmaxf(*put, 0.8f * (float)fmin(fmax(reach - distance, 0.0), 1.0));
    }
  }
}

void stratus_sheet_line_in_world(stratus_sheet* sheet, const double from[3], const double to[3])
{
  double a[2], b[2];
  if (stratus_sheet_project(sheet, from, a) && stratus_sheet_project(sheet, to, b)) {
    stratus_sheet_line(sheet, a, b);
  }
}

void stratus_sheet_lay(stratus_sheet* sheet, bool behind)
{
  const size_t pixels = (size_t)sheet->width * (size_t)sheet->height;
  for (size_t i = 0; i < pixels; ++i) {
    float* const to = &sheet->rgba[4 * i];
    const float coverage = sheet->coverage[i], of_line = behind ? 1.0f - to[3] : 1.0f, of_picture = behind ? 1.0f : 1.0f - coverage;
    if (coverage > 0.0f) {
      for (int c = 0; c < 4; ++c) {
        to[c] = of_picture * to[c] + of_line * coverage * (c < 3 ? sheet->ink : 1.0f);
      }
    }
    sheet->coverage[i] = 0.0f;
  }
}

void stratus_sheet_put(stratus_sheet* sheet, int x, int y, float coverage, const float rgb[3])
{
  if (x < 0 || y < 0 || x >= sheet->width || y >= sheet->height || coverage <= 0.0f) {
    return;
  }
  float* const to = &sheet->rgba[4 * ((size_t)y * (size_t)sheet->width + (size_t)x)];
  for (int c = 0; c < 4; ++c) {
    to[c] = coverage * (c < 3 ? rgb[c] : 1.0f) + (1.0f - coverage) * to[c];
  }
}

/* ---- places of text */

stratus_pixels stratus_sheet_place(int width, int height, const double at[2], double across, double along)
{
  const double far = 1e6; /* beyond any picture */
  const int left = (int)round(fmin(fmax(at[0] - across * width, -far), far)),
            bottom = (int)round(fmin(fmax(at[1] - along * height, -far), far));
  const stratus_pixels where = { left, bottom, left + width - 1, bottom + height - 1 };
  return where;
}

bool stratus_pixels_meet(stratus_pixels a, stratus_pixels b)
{
  return a.left <= b.right && b.left <= a.right && a.bottom <= b.top && b.bottom <= a.top;
}

static stratus_status append(stratus_context* context, stratus_pixel_list* to, stratus_pixels one)
{
  if (to->count == to->capacity) {
    void* memory = NULL;
    const size_t capacity = to->capacity ? 2 * to->capacity : 64;
    TRY(stratus_allocate(context, capacity, sizeof one, &memory));
    if (to->count) {
      memcpy(memory, to->list, to->count * sizeof one);
    }
    stratus_release(context, to->list);
    to->list = memory;
    to->capacity = capacity;
  }
  to->list[to->count++] = one;
  return STRATUS_OK;
}

stratus_status stratus_sheet_take(stratus_sheet* sheet, stratus_pixels where)
{
  return append(sheet->context, &sheet->taken, where);
}

stratus_status stratus_sheet_keep_off(stratus_sheet* sheet, const double from[2], const double to[2])
{
  const int count = (int)fmin(stratus_length_2(to[0] - from[0], to[1] - from[1]) / 4.0, 4096.0) + 1;
  for (int i = 0; i <= count; ++i) {
    const double t = (double)i / count, x = from[0] + t * (to[0] - from[0]), y = from[1] + t * (to[1] - from[1]);
    if (x >= 0.0 && y >= 0.0 && x < sheet->width && y < sheet->height) {
      const stratus_pixels near = { (int)x - 2, (int)y - 2, (int)x + 2, (int)y + 2 };
      TRY(append(sheet->context, &sheet->lines, near));
    }
  }
  return STRATUS_OK;
}

static bool meets_any(const stratus_pixel_list* of, stratus_pixels where)
{
  for (size_t i = 0; i < of->count; ++i) {
    if (stratus_pixels_meet(of->list[i], where)) {
      return true;
    }
  }
  return false;
}

bool stratus_sheet_is_free(const stratus_sheet* sheet, stratus_pixels where, bool title)
{
  const int gap = title ? (int)(0.3 * sheet->size) : 0;
  const stratus_pixels wide = { where.left - gap, where.bottom - gap, where.right + gap, where.top + gap };
  return where.left >= EDGE && where.bottom >= EDGE && where.right < sheet->width - EDGE && where.top < sheet->height - EDGE &&
    !meets_any(&sheet->taken, wide) && !(title && meets_any(&sheet->lines, wide));
}

stratus_status stratus_sheet_write(stratus_sheet* sheet, const stratus_text* text, stratus_pixels where, int part, const char* line)
{
  const float rgb[3] = { sheet->ink, sheet->ink, sheet->ink };
  for (int j = 0; j < text->height; ++j) {
    for (int i = 0; i < text->width; ++i) {
      stratus_sheet_put(sheet, where.left + i, where.bottom + j, text->coverage[j * text->width + i], rgb);
    }
  }
  if (sheet->count < sheet->most) {
    stratus_annotation_text* const to = &sheet->texts[sheet->count];
    to->left = where.left;
    to->bottom = where.bottom;
    to->right = where.right;
    to->top = where.top;
    to->part = part;
    snprintf(to->text, sizeof to->text, "%s", line);
  }
  ++sheet->count;
  return stratus_sheet_take(sheet, where);
}

stratus_status stratus_sheet_write_line(
  stratus_sheet* sheet, const char* line, double size, const double at[2], double across, double along, int part)
{
  const stratus_pixels where = stratus_sheet_place(stratus_text_width(line, size), stratus_text_height(line, size), at, across, along);
  if (!*line || !stratus_sheet_is_free(sheet, where, false)) {
    return STRATUS_OK;
  }
  stratus_text text;
  TRY(stratus_text_create(sheet->context, line, size, &text));
  const stratus_status status = stratus_sheet_write(sheet, &text, where, part, line);
  stratus_text_destroy(sheet->context, &text);
  return status;
}
