// SPDX-License-Identifier: BSD-3-Clause
// Conversion of options to the ray caster's settings, and the output of its report.
#pragma once

#include "input.h"
#include "options.h"
#include "support.h"
#include "transfer.h"

#include <memory>

namespace cli {

// Sets the planes of --crop and --slice, which are given in the numbers of the file's axes, in the grid's coordinates.
void set_planes(options& o, const options& given);
// The plane of --slice; no surface where there is none.
stratus_slice slice_of(const options& o, int up);
// Sets the lights of --sun and --sun-at, and returns their number. `up` is the axis of heights, 0 to 2.
int set_suns(const options& o, int up, stratus_light lights[STRATUS_LIGHTS_MAX]);
// Sets the sky of --sky, without one nothing but `upwards`.
void set_sky(const options& o, int up, double zenith[3], double horizon[3], double upwards[3]);
// Sets whether matter is lit, and how.
void set_light(const options& o, int up, int& shade, stratus_shading& shading);
// All that the options say but for the parts of the volume. `up` is the axis of heights, 0 to 2.
stratus_ray_cast_options casting_of(const options& o, int up);

// The parts of one volume that are drawn: its crop and its mask, which is read once.
class volume_parts
{
public:
  // Throws failure for a mask that does not fit the volume.
  void set(const options& o, context& core, const stratus_volume& volume, stratus_ray_cast_options& cast);

private:
  std::unique_ptr<input> Mask;
};

// Prints the rows from "opacity" on.
void print_cast(const options& o, const context& core, const transfer& functions, const stratus_ray_cast_report& r);
// Throws failure for an audit that found pixels that differ.
void judge_cast(const options& o, const stratus_ray_cast_report& r);
} // namespace cli
