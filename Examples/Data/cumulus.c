/* SPDX-License-Identifier: BSD-3-Clause
 * make-cumulus OUT.nc [SIDE [LEVELS]]: writes a field of cumulus clouds that grow for three hours, as a cloud model would: liquid water on
 * SIDE x SIDE columns (default 96) of LEVELS stretched levels (default 64), packed in 16 bits, every 15 minutes. The clouds are spheres
 * that rise, ruffled by noise.
 */
#include "netcdf_writing.h"
#include "noise.h"

enum { usual_levels = 64, most = 4096, steps = 13, clouds = 14 };
static const double width = 6400.0;     /* metres */
static const double base = 620.0;       /* of clouds, metres */
static const double most_water = 0.003; /* kg/kg */

struct cloud {
  double x, y, radius, birth, life; /* metres, minutes */
};

static void sow(struct cloud* all)
{
  for (int i = 0; i < clouds; ++i) {
    all[i].x = width * (0.5 + 0.42 * lattice_noise(i, 1, 0));
    all[i].y = width * (0.5 + 0.42 * lattice_noise(i, 2, 0));
    all[i].radius = 620.0 + 300.0 * lattice_noise(i, 3, 0);
    all[i].birth = 60.0 + 60.0 * lattice_noise(i, 4, 0);
    all[i].life = 110.0 + 40.0 * lattice_noise(i, 5, 0);
  }
}

/* How far within a cloud a place is: above 0 in it, of the order 1 in its middle. */
static double depth_in(const struct cloud* one, double x, double y, double z, double minutes)
{
  const double age = (minutes - one->birth) / one->life;
  if (age <= 0.0 || age >= 1.6) {
    return -1.0;
  }
  const double grown = age < 0.8 ? smooth_step(age / 0.8) : 1.0 - 0.8 * smooth_step((age - 0.8) / 0.8);
  double deepest = -1.0;
  for (int tower = 0; tower < 3; ++tower) { /* each smaller and higher than the one below */
    const double radius = one->radius * grown * (1.0 - 0.22 * tower);
    const double height = base + radius * (0.35 + 0.85 * tower * grown);
    const double side = 0.25 * one->radius * tower;
    const double dx = x - one->x - side, dy = y - one->y - 0.3 * side, dz = 0.85 * (z - height);
    const double depth = 1.0 - sqrt(dx * dx + dy * dy + dz * dz) / fmax(radius, 1.0);
    deepest = fmax(deepest, depth);
  }
  return deepest;
}

static double water(const struct cloud* all, double x, double y, double z, double minutes)
{
  if (z < base - 60.0) {
    return 0.0;
  }
  double deepest = -1.0;
  for (int i = 0; i < clouds; ++i) {
    deepest = fmax(deepest, depth_in(&all[i], x, y, z, minutes));
  }
  if (deepest <= -0.6) {
    return 0.0;
  }
  const double ruffled = deepest + 0.85 * billows(x / 520.0, y / 520.0, z / 420.0 - minutes / 45.0, 5);
  const double flat = 1.0 / (1.0 + exp(-(z - base - 25.0 * noise(x / 300.0, y / 300.0, 0.0)) / 18.0));
  const double moist = 0.35 + 0.65 * fmin((z - base) / 1500.0, 1.0); /* water grows with the height over the base */
  return ruffled > 0.0 ? most_water * flat * fmax(moist, 0.0) * fmin(ruffled * 4.0, 1.0) : 0.0;
}

int main(int count, char** words)
{
  const int side = count > 2 ? atoi(words[2]) : 96, levels = count > 3 ? atoi(words[3]) : usual_levels;
  if (count < 2 || side < 2 || side > most || levels < 2 || levels > most) {
    fprintf(stderr, "make-cumulus OUT.nc [SIDE, 2..4096 [LEVELS, 2..4096]]\n");
    return 2;
  }
  int file = -1;
  must(nc_create(words[1], NC_CLOBBER | NC_64BIT_OFFSET, &file));
  const int ids[4] = { dimension(file, "time", NC_UNLIMITED), dimension(file, "z", (size_t)levels), dimension(file, "y", (size_t)side),
    dimension(file, "x", (size_t)side) };
  const int time = variable(file, "time", NC_DOUBLE, 1, &ids[0], "hours since 2024-06-01 09:00", NULL);
  const int z = variable(file, "z", NC_FLOAT, 1, &ids[1], "m", "height above ground");
  const int y = variable(file, "y", NC_FLOAT, 1, &ids[2], "km", NULL);
  const int x = variable(file, "x", NC_FLOAT, 1, &ids[3], "km", NULL);
  const int qc = variable(file, "qc", NC_SHORT, 4, ids, "g kg-1", "cloud liquid water mixing ratio");
  const double packing = 1e-4; /* g/kg */
  const short fill = -32768;
  text(file, z, "positive", "up");
  must(nc_put_att_double(file, qc, "scale_factor", NC_DOUBLE, 1, &packing));
  must(nc_put_att_short(file, qc, "_FillValue", NC_SHORT, 1, &fill));
  text(file, NC_GLOBAL, "Conventions", "CF-1.8");
  text(file, NC_GLOBAL, "title", "Cumulus over land, made by Stratus' example");
  must(nc_enddef(file));
  double height[most], across[most];
  for (int k = 0; k < levels; ++k) { /* of 64: 20 m at the ground, each layer 3 % thicker than the one below */
    height[k] = 20.0 * (pow(1.03, k * (usual_levels - 1.0) / (levels - 1.0)) - 1.0) / 0.03;
  }
  for (int i = 0; i < side; ++i) {
    across[i] = width * i / (side - 1) / 1000.0;
  }
  must(nc_put_var_double(file, z, height));
  must(nc_put_var_double(file, y, across));
  must(nc_put_var_double(file, x, across));
  struct cloud all[clouds];
  sow(all);
  const size_t columns = (size_t)side * (size_t)side;
  short* values = memory(columns * (size_t)levels, sizeof *values);
  for (size_t step = 0; step < steps; ++step) {
    const double minutes = 15.0 * (double)step, hours = minutes / 60.0;
    for (size_t i = 0; i < columns * (size_t)levels; ++i) {
      const size_t column = i % columns;
      const double at_x = 1000.0 * across[column % (size_t)side], at_y = 1000.0 * across[column / (size_t)side];
      values[i] = (short)lround(water(all, at_x, at_y, height[i / columns], minutes) * 1000.0 / packing);
    }
    const size_t start[4] = { step, 0, 0, 0 }, length[4] = { 1, (size_t)levels, (size_t)side, (size_t)side };
    must(nc_put_vara_double(file, time, start, length, &hours));
    must(nc_put_vara_short(file, qc, start, length, values));
  }
  free(values);
  must(nc_close(file));
  return 0;
}
