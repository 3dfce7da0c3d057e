// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusProjection.h"

#include "vtkStratusText.h"

#include <algorithm>
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

bool IsKnown(const std::string& name)
{
  return std::any_of(Mappings.begin(), Mappings.end(), [&name](const Mapping& one) { return name == one.Name; });
}

// The whole coordinate reference system as one text, "" if the file has none.
std::string SystemOf(const vtkStratusNetCDFModel& file, const Variable& mapping)
{
  std::string text;
  for (const char* attribute : { "crs_wkt", "spatial_ref", "wkt", "EPSG_code" }) {
    text = text.empty() ? vtkStratusTrimmed(file.Text(mapping, attribute)) : text;
  }
  return text;
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
  file.Fail(what + " is none of the known ones: " + names + "; and it has no crs_wkt");
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
    if (one && name != "latitude_longitude" && (!name.empty() || !SystemOf(file, *one).empty())) {
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
  double Angle = Degree, Plane = 1.0; // PROJ's units of a degree on the Earth, and metres or degrees of PROJ's unit on the plane
  double Meridian = 0.0;              // degrees from Greenwich
  bool IsSystem = false, IsRotated = false;

  Proj() : Context(proj_context_create()) { proj_log_level(this->Context, PJ_LOG_NONE); }
  ~Proj()
  {
    proj_destroy(this->Transformation);
    proj_context_destroy(this->Context);
  }
  std::string GetError() const
  {
    const int error = proj_context_errno(this->Context);
    const char* text = error ? proj_errno_string(error) : nullptr;
    return this->IsSystem ? "it is no map projection of the Earth" : text ? text : "it is no text of a coordinate reference system";
  }

  // Sets the transformation by a coordinate reference system. Returns its name, "" if it has no map projection.
  std::string SetSystem(const std::string& text)
  {
    using Object = std::unique_ptr<PJ, PJ* (*)(PJ*)>;
    const auto own = [](PJ* object) { return Object(object, proj_destroy); };
    Object system = own(proj_create(this->Context, text.c_str()));
    while (system && (proj_get_type(system.get()) == PJ_TYPE_BOUND_CRS || proj_get_type(system.get()) == PJ_TYPE_COMPOUND_CRS)) {
      const bool bound = proj_get_type(system.get()) == PJ_TYPE_BOUND_CRS;
      system = own(
        bound ? proj_get_source_crs(this->Context, system.get()) : proj_crs_get_sub_crs(this->Context, system.get(), 0)); // the horizontal
    }
    this->IsSystem = system != nullptr;
    const Object base = own(system ? proj_get_source_crs(this->Context, system.get()) : nullptr);
    const Object given = own(base ? proj_create_crs_to_crs_from_pj(this->Context, base.get(), system.get(), nullptr, nullptr) : nullptr);
    this->Transformation = given ? proj_normalize_for_visualization(this->Context, given.get()) : nullptr;
    if (!this->Transformation) {
      return "";
    }
    const auto unit = [&](const PJ* of) { // radians or metres
      const Object axes = own(proj_crs_get_coordinate_system(this->Context, of));
      double factor = 1.0;
      return axes && proj_cs_get_axis_info(this->Context, axes.get(), 0, nullptr, nullptr, nullptr, &factor, nullptr, nullptr, nullptr)
        ? factor
        : 1.0;
    };
    const Object meridian = own(proj_get_prime_meridian(this->Context, base.get()));
    double longitude = 0.0, factor = 1.0;
    if (meridian && proj_prime_meridian_get_parameters(this->Context, meridian.get(), &longitude, &factor, nullptr)) {
      this->Meridian = longitude * factor / Degree;
    }
    this->Angle = Degree / unit(base.get());
    this->IsRotated = proj_get_type(system.get()) != PJ_TYPE_PROJECTED_CRS;
    this->Plane = unit(system.get()) / (this->IsRotated ? Degree : 1.0);
    const char* name = proj_get_name(system.get());
    return name && *name ? name : "unnamed";
  }

  bool ToPlane(const double degrees[2], double at[2]) const
  {
    proj_errno_reset(this->Transformation);
    const PJ_COORD from = proj_coord((degrees[0] - this->Meridian) * this->Angle, degrees[1] * this->Angle, 0.0, 0.0);
    const PJ_COORD to = proj_trans(this->Transformation, PJ_FWD, from);
    at[0] = to.xy.x * this->Plane;
    at[1] = to.xy.y * this->Plane;
    return std::isfinite(at[0]) && std::isfinite(at[1]);
  }
  bool ToEarth(const double at[2], double degrees[2]) const
  {
    proj_errno_reset(this->Transformation);
    const PJ_COORD to = proj_trans(this->Transformation, PJ_INV, proj_coord(at[0] / this->Plane, at[1] / this->Plane, 0.0, 0.0));
    degrees[0] = to.xy.x / this->Angle + this->Meridian;
    degrees[1] = to.xy.y / this->Angle;
    return std::isfinite(degrees[0]) && std::isfinite(degrees[1]);
  }
};
#else
struct vtkStratusProjection::Proj {
};
#endif

vtkStratusProjection::vtkStratusProjection(const vtkStratusNetCDFModel& file, const Variable& mapping, double metres)
    : Library(std::make_unique<Proj>())
{
  const std::string name = vtkStratusTrimmed(file.Text(mapping, "grid_mapping_name")), system = SystemOf(file, mapping);
  const bool by_system = !IsKnown(name) && !system.empty();
  this->Description = "'" + mapping.Name + "'" + (name.empty() || by_system ? "" : " (" + name + ")");
  this->Rotated = name == ::Rotated;
  const std::string text = by_system ? "" : TextOf(file, mapping, metres, name, "the grid mapping " + this->Description);
#ifdef STRATUS_PROJ
  if (by_system) {
    const std::string title = this->Library->SetSystem(system);
    if (title.empty()) {
      file.Fail("PROJ finds no projection in the text of the grid mapping " + this->Description + ", '" + system.substr(0, 60) +
        (system.size() > 60 ? "...'" : "'") + ": " + this->Library->GetError());
    }
    this->Description += " (" + title + ")";
    this->Rotated = this->Library->IsRotated;
    return;
  }
  this->Library->Transformation = proj_create(this->Library->Context, text.c_str());
  this->Library->Plane = this->Rotated ? 1.0 / Degree : 1.0;
  if (!this->Library->Transformation) {
    file.Fail("PROJ refuses the grid mapping " + this->Description + " as '" + text.substr(1) + "': " + this->Library->GetError());
  }
#else
  file.Fail("places by the grid mapping " + this->Description + " need PROJ, which this build lacks (Debian: libproj-dev)");
#endif
}

vtkStratusProjection::~vtkStratusProjection() = default;

bool vtkStratusProjection::ToPlane(const double degrees[2], double at[2]) const
{
#ifdef STRATUS_PROJ
  return this->Library->ToPlane(degrees, at);
#else
  at[0] = at[1] = degrees[0] * std::nan("");
  return false;
#endif
}

bool vtkStratusProjection::ToEarth(const double at[2], double degrees[2]) const
{
#ifdef STRATUS_PROJ
  return this->Library->ToEarth(at, degrees);
#else
  degrees[0] = degrees[1] = at[0] * std::nan("");
  return false;
#endif
}
