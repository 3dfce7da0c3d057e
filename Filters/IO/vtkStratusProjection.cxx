// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusProjection.h"

#include "vtkStratusText.h"

#include <array>
#include <cmath>
#include <vector>

#ifdef STRATUS_PROJ
#include <proj.h>
#endif

namespace {
using Variable = vtkStratusNetCDFVariable;

constexpr double Degree = 0.017453292519943295;
constexpr const char* Rotated = "rotated_latitude_longitude";
constexpr const char* Geostationary = "geostationary";

// An attribute of a grid mapping as a parameter of PROJ.
struct Parameter {
  const char* Attribute;
  const char* Other; // attribute that may replace it, nullptr: none
  const char* Key;
  bool Needed; // otherwise PROJ's default is used, which is CF's
};

// The parallel or the factor at which the map has the Earth's scale.
constexpr const char* Parallel = "standard_parallel";
constexpr const char* Scale = "scale_factor_at_projection_origin";

enum ScaleType { None, Conic, Cylindric }; // Conic: one or two standard parallels. Cylindric: one, or a factor

struct Mapping {
  const char* Name;
  const char* Proj;
  ScaleType Scales;
  std::array<Parameter, 3> Parameters; // those without a key are none
};

constexpr Parameter Latitude = { "latitude_of_projection_origin", nullptr, "lat_0", true };
constexpr Parameter Longitude = { "longitude_of_projection_origin", "longitude_of_central_meridian", "lon_0", true };
constexpr Parameter Meridian = { "longitude_of_central_meridian", "longitude_of_projection_origin", "lon_0", true };
constexpr Parameter Pole = { "straight_vertical_longitude_from_pole", "longitude_of_projection_origin", "lon_0", true };
constexpr Parameter Height = { "perspective_point_height", nullptr, "h", true };
constexpr Parameter Factor = { Scale, nullptr, "k_0", true };
constexpr Parameter Central = { "scale_factor_at_central_meridian", Scale, "k_0", true };
constexpr Parameter Nothing = { nullptr, nullptr, nullptr, false };

constexpr std::array<Mapping, 14> Mappings = { {
  { "albers_conical_equal_area", "aea", Conic, { { Meridian, Latitude, Nothing } } },
  { "azimuthal_equidistant", "aeqd", None, { { Longitude, Latitude, Nothing } } },
  { Geostationary, "geos", None, { { Longitude, Height, Nothing } } },
  { "lambert_azimuthal_equal_area", "laea", None, { { Longitude, Latitude, Nothing } } },
  { "lambert_conformal_conic", "lcc", Conic, { { Meridian, Latitude, Nothing } } },
  { "lambert_cylindrical_equal_area", "cea", Cylindric, { { Meridian, Nothing, Nothing } } },
  { "mercator", "merc", Cylindric, { { Longitude, Nothing, Nothing } } },
  { "orthographic", "ortho", None, { { Longitude, Latitude, Nothing } } },
  { "polar_stereographic", "stere", Cylindric, { { Pole, Latitude, Nothing } } },
  { Rotated, "ob_tran +o_proj=longlat", None, { { Nothing, Nothing, Nothing } } },
  { "sinusoidal", "sinu", None, { { Meridian, Nothing, Nothing } } },
  { "stereographic", "stere", None, { { Longitude, Latitude, Factor } } },
  { "transverse_mercator", "tmerc", None, { { Meridian, Latitude, Central } } },
  { "vertical_perspective", "nsper", None, { { Longitude, Latitude, Height } } },
} };

// Ellipsoids by their names in CF's table of horizontal datums, which are EPSG's.
struct Ellipsoid {
  const char* Name;
  const char* Proj;
};
constexpr std::array<Ellipsoid, 12> Ellipsoids = { { { "airy 1830", "airy" }, { "airy modified 1849", "mod_airy" },
  { "bessel 1841", "bessel" }, { "clarke 1866", "clrk66" }, { "clarke 1880 (rgs)", "clrk80" }, { "grs 1967", "GRS67" },
  { "grs 1980", "GRS80" }, { "international 1924", "intl" }, { "krassowsky 1940", "krass" }, { "wgs 72", "WGS72" }, { "wgs 84", "WGS84" },
  { "grs 1967 modified", "aust_SA" } } };

// The parameters of one mapping as text for PROJ.
class Text
{
public:
  Text(const vtkStratusNetCDFModel& file, const Variable& mapping, const std::string& what) : File(file), From(mapping), What(what) {}

  void Add(const std::string& key, double value) { this->All += " +" + key + "=" + vtkStratusNumberText(value); }
  void Add(const std::string& word) { this->All += " +" + word; }
  const std::string& Get() const { return this->All; }

  double Number(const char* attribute, const char* other, bool needed, double usual) const
  {
    double value = usual;
    const bool found = this->File.Number(this->From, attribute, value) || (other && this->File.Number(this->From, other, value));
    if (!found && needed) {
      this->File.Fail(this->What + " has no attribute " + attribute + (other ? std::string(" or ") + other : ""));
    }
    if (!std::isfinite(value)) {
      this->File.Fail(this->What + " has the attribute " + attribute + " = " + vtkStratusNumberText(value) + ", must be finite");
    }
    return value;
  }

  void AddScale(ScaleType type)
  {
    const std::vector<double> parallels = this->File.NumbersOf(this->From, Parallel);
    if (type == Conic) {
      if (parallels.empty() || parallels.size() > 2) {
        this->File.Fail(
          this->What + " has " + std::to_string(parallels.size()) + " numbers in the attribute standard_parallel, must be 1 or 2");
      }
      this->Add("lat_1", parallels.front());
      this->Add("lat_2", parallels.back());
    } else if (type == Cylindric && !parallels.empty()) {
      this->Add("lat_ts", parallels.front());
    } else if (type == Cylindric) {
      this->Add("k_0", this->Number(Scale, Parallel, true, 1.0));
    }
  }

  // The Earth's shape: axes, else a name, else the readers' sphere.
  void AddShape()
  {
    const double none = std::nan(""), sphere = this->Optional("earth_radius", none), major = this->Optional("semi_major_axis", sphere),
                 minor = this->Optional("semi_minor_axis", none), flattening = this->Optional("inverse_flattening", none);
    const std::string name = vtkStratusLowerCase(vtkStratusTrimmed(this->File.Text(this->From, "reference_ellipsoid_name")));
    if (std::isfinite(major)) {
      this->Add("a", major);
      if (std::isfinite(minor)) {
        this->Add("b", minor);
      } else if (flattening > 0.0) {
        this->Add("rf", flattening);
      } else {
        this->Add("b", major);
      }
      return;
    }
    std::string names;
    for (const Ellipsoid& one : Ellipsoids) {
      if (name == one.Name) {
        this->Add(std::string("ellps=") + one.Proj);
        return;
      }
      names += (names.empty() ? "" : ", ") + std::string(one.Name);
    }
    if (!name.empty()) {
      this->File.Fail(
        this->What + " has no axes, and the reference_ellipsoid_name '" + name + "', which is none of the known ones: " + names);
    }
    this->Add("R", 6371000.0);
  }

  void AddFalse(const char* attribute, const char* key, double metres)
  {
    const double value = this->Optional(attribute, 0.0);
    if (value != 0.0) {
      this->Add(key, value * metres);
    }
  }

  double Optional(const char* attribute, double usual) const
  {
    double value = usual;
    this->File.Number(this->From, attribute, value);
    return value;
  }

private:
  const vtkStratusNetCDFModel& File;
  const Variable& From;
  const std::string& What;
  std::string All;
};

// The instrument's axis that sweeps: x if the other one is fixed along y.
std::string SweepOf(const vtkStratusNetCDFModel& file, const Variable& mapping)
{
  const std::string sweep = vtkStratusLowerCase(vtkStratusTrimmed(file.Text(mapping, "sweep_angle_axis"))),
                    fixed = vtkStratusLowerCase(vtkStratusTrimmed(file.Text(mapping, "fixed_angle_axis")));
  return sweep == "x" || (sweep.empty() && fixed == "y") ? "sweep=x" : "sweep=y";
}

// The text for PROJ.
std::string TextOf(
  const vtkStratusNetCDFModel& file, const Variable& mapping, double metres, const std::string& name, const std::string& what)
{
  std::string names;
  for (const Mapping& one : Mappings) {
    names += (names.empty() ? "" : ", ") + std::string(one.Name);
    if (name != one.Name) {
      continue;
    }
    Text text(file, mapping, what);
    text.Add(std::string("proj=") + one.Proj);
    for (const Parameter& each : one.Parameters) {
      if (each.Key) {
        text.Add(each.Key, text.Number(each.Attribute, each.Other, each.Needed, 0.0));
      }
    }
    text.AddScale(one.Scales);
    if (name == Rotated) {
      text.Add("o_lat_p", text.Number("grid_north_pole_latitude", nullptr, true, 90.0));
      text.Add("o_lon_p", text.Optional("north_pole_grid_longitude", 0.0));
      text.Add("lon_0", 180.0 + text.Number("grid_north_pole_longitude", nullptr, true, 0.0));
    } else if (name == Geostationary) {
      text.Add(SweepOf(file, mapping));
    }
    text.AddShape();
    text.AddFalse("longitude_of_prime_meridian", "pm", 1.0);
    if (name != Rotated) { // whose coordinates are angles
      text.AddFalse("false_easting", "x_0", metres);
      text.AddFalse("false_northing", "y_0", metres);
    }
    return text.Get();
  }
  file.Fail(what + " is none of the known ones: " + names);
}
} // namespace

const Variable* vtkStratusProjection::FindMapping(const vtkStratusNetCDFModel& file, const Variable& variable)
{
  // "crs", or "crs: x y other: lat lon"
  for (std::string word : vtkStratusWords(file.Text(variable, "grid_mapping"))) {
    if (!word.empty() && word.back() == ':') {
      word.pop_back();
    }
    const Variable* one = file.Find(word, &variable);
    const std::string name = one ? file.Text(*one, "grid_mapping_name") : "";
    if (!name.empty() && name != "latitude_longitude") {
      return one;
    }
  }
  return nullptr;
}

double vtkStratusProjection::MetresPerRadian(const vtkStratusNetCDFModel& file, const Variable& mapping)
{
  double height = 0.0;
  return file.Text(mapping, "grid_mapping_name") == Geostationary && file.Number(mapping, Height.Attribute, height) ? height : 0.0;
}

#ifdef STRATUS_PROJ
struct vtkStratusProjection::Proj {
  PJ_CONTEXT* Context;
  PJ* Transformation = nullptr;

  Proj() : Context(proj_context_create()) { proj_log_level(this->Context, PJ_LOG_NONE); }
  ~Proj()
  {
    proj_destroy(this->Transformation);
    proj_context_destroy(this->Context);
  }
  // factor: from the unit of `from` to PROJ's.
  bool Convert(PJ_DIRECTION direction, const double from[2], double factor, double to[2], double unit) const
  {
    proj_errno_reset(this->Transformation);
    const PJ_COORD result = proj_trans(this->Transformation, direction, proj_coord(from[0] * factor, from[1] * factor, 0.0, 0.0));
    to[0] = result.xy.x / unit;
    to[1] = result.xy.y / unit;
    return std::isfinite(to[0]) && std::isfinite(to[1]);
  }
};
#else
struct vtkStratusProjection::Proj {
};
#endif

vtkStratusProjection::vtkStratusProjection(const vtkStratusNetCDFModel& file, const Variable& mapping, double metres)
    : Library(std::make_unique<Proj>())
{
  const std::string name = vtkStratusTrimmed(file.Text(mapping, "grid_mapping_name"));
  this->Description = "'" + mapping.Name + "' (" + name + ")";
  this->Rotated = name == ::Rotated;
  const std::string text = TextOf(file, mapping, metres, name, "the grid mapping " + this->Description);
#ifdef STRATUS_PROJ
  this->Library->Transformation = proj_create(this->Library->Context, text.c_str());
  if (!this->Library->Transformation) {
    file.Fail("PROJ refuses the grid mapping " + this->Description + " as '" + text.substr(1) +
      "': " + proj_errno_string(proj_context_errno(this->Library->Context)));
  }
#else
  file.Fail("places by the grid mapping " + this->Description + " need PROJ, which this build lacks (Debian: libproj-dev)");
#endif
}

vtkStratusProjection::~vtkStratusProjection() = default;

bool vtkStratusProjection::ToPlane(const double degrees[2], double at[2]) const
{
#ifdef STRATUS_PROJ
  return this->Library->Convert(PJ_FWD, degrees, Degree, at, this->Rotated ? Degree : 1.0);
#else
  at[0] = at[1] = degrees[0] * std::nan("");
  return false;
#endif
}

bool vtkStratusProjection::ToEarth(const double at[2], double degrees[2]) const
{
#ifdef STRATUS_PROJ
  return this->Library->Convert(PJ_INV, at, this->Rotated ? Degree : 1.0, degrees, Degree);
#else
  degrees[0] = degrees[1] = at[0] * std::nan("");
  return false;
#endif
}
