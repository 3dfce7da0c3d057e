// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusHeights.h"
#include "vtkStratusText.h"
#include "stratus/cloud.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr double GasConstant = 287.05; // of dry air, J kg-1 K-1
constexpr double SeaDensity = 1025.0;  // kg m-3

using Quantity = vtkStratusQuantity;

double OceanS(const double* t, double) // s, C, eta, depth, depth_c
{
  const double rest = t[4] * t[0] + (t[3] - t[4]) * t[1];
  return rest + t[2] * (1.0 + rest / t[3]);
}

double OceanS2(const double* t, double) // s, C, eta, depth, depth_c
{
  return t[2] + (t[2] + t[3]) * (t[4] * t[0] + t[3] * t[1]) / (t[4] + t[3]);
}

// The stretching of Song and Haidvogel (1994), which is 0 and -1 at both ends; even where a is 0.
double OceanSOld(const double* t, double) // s, eta, depth, a, b, depth_c
{
  const double s = t[0], a = t[3], b = t[4];
  const double stretching = std::fabs(a) < 1e-9
    ? s
    : (1.0 - b) * std::sinh(a * s) / std::sinh(a) + b * (std::tanh(a * (s + 0.5)) / (2.0 * std::tanh(0.5 * a)) - 0.5);
  return t[1] * (1.0 + s) + t[5] * s + (t[2] - t[5]) * stretching;
}

// Since CF 1.9 either sigma or zlev is missing at each level; before, nsigma was the number of levels with sigma.
double OceanSigmaZ(const double* t, double level) // sigma, eta, depth, depth_c, zlev, nsigma
{
  const bool has_sigma = std::isfinite(t[0]), has_height = std::isfinite(t[4]);
  if (has_sigma && (has_height ? level <= t[5] : true)) {
    return has_height && std::isnan(t[5]) ? NAN : t[1] + t[0] * (std::min(t[3], t[2]) + t[1]);
  }
  return has_sigma && std::isnan(t[5]) ? NAN : t[4];
}

double OceanDoubleSigma(const double* t, double level) // sigma, depth, z1, z2, a, href, k_c
{
  const double sum = t[2] + t[3], difference = t[2] - t[3];
  const double middle = 0.5 * sum + (difference == 0.0 ? 0.0 : 0.5 * difference * std::tanh(2.0 * t[4] / difference * (t[1] - t[5])));
  return level <= t[6] ? t[0] * middle : middle + (t[0] - 1.0) * (t[1] - middle);
}

const vtkStratusFormula Formulas[] = {
  { "atmosphere_ln_pressure_coordinate", { { "p0", Quantity::Pressure }, { "lev", Quantity::None } }, true,
    [](const double* t, double) { return t[0] * std::exp(-t[1]); } },
  { "atmosphere_sigma_coordinate", { { "sigma", Quantity::None }, { "ps", Quantity::Pressure }, { "ptop", Quantity::Pressure } }, true,
    [](const double* t, double) { return t[2] + t[0] * (t[1] - t[2]); } },
  { "atmosphere_hybrid_sigma_pressure_coordinate", { { "ap", Quantity::Pressure }, { "b", Quantity::None }, { "ps", Quantity::Pressure } },
    true, [](const double* t, double) { return t[0] + t[1] * t[2]; } },
  { "atmosphere_hybrid_sigma_pressure_coordinate",
    { { "a", Quantity::None }, { "b", Quantity::None }, { "ps", Quantity::Pressure }, { "p0", Quantity::Pressure } }, true,
    [](const double* t, double) { return t[0] * t[3] + t[1] * t[2]; } },
  { "atmosphere_hybrid_height_coordinate", { { "a", Quantity::Length }, { "b", Quantity::None }, { "orog", Quantity::Length } }, false,
    [](const double* t, double) { return t[0] + t[1] * t[2]; } },
  { "atmosphere_sleve_coordinate",
    { { "a", Quantity::None }, { "b1", Quantity::None }, { "b2", Quantity::None }, { "ztop", Quantity::Length },
      { "zsurf1", Quantity::Length }, { "zsurf2", Quantity::Length } },
    false, [](const double* t, double) { return t[0] * t[3] + t[1] * t[4] + t[2] * t[5]; } },
  { "ocean_sigma_coordinate", { { "sigma", Quantity::None }, { "eta", Quantity::Length }, { "depth", Quantity::Length } }, false,
    [](const double* t, double) { return t[1] + t[0] * (t[2] + t[1]); } },
  { "ocean_s_coordinate",
    { { "s", Quantity::None }, { "eta", Quantity::Length }, { "depth", Quantity::Length }, { "a", Quantity::None }, { "b", Quantity::None },
      { "depth_c", Quantity::Length } },
    false, OceanSOld },
  { "ocean_s_coordinate_g1",
    { { "s", Quantity::None }, { "C", Quantity::None }, { "eta", Quantity::Length }, { "depth", Quantity::Length },
      { "depth_c", Quantity::Length } },
    false, OceanS },
  { "ocean_s_coordinate_g2",
    { { "s", Quantity::None }, { "C", Quantity::None }, { "eta", Quantity::Length }, { "depth", Quantity::Length },
      { "depth_c", Quantity::Length } },
    false, OceanS2 },
  { "ocean_sigma_z_coordinate",
    { { "sigma", Quantity::None, true }, { "eta", Quantity::Length }, { "depth", Quantity::Length }, { "depth_c", Quantity::Length },
      { "zlev", Quantity::Length, true }, { "nsigma", Quantity::None } },
    false, OceanSigmaZ },
  { "ocean_sigma_z_coordinate",
    { { "sigma", Quantity::None, true }, { "eta", Quantity::Length }, { "depth", Quantity::Length }, { "depth_c", Quantity::Length },
      { "zlev", Quantity::Length, true } },
    false, OceanSigmaZ },
  { "ocean_double_sigma_coordinate",
    { { "sigma", Quantity::None }, { "depth", Quantity::Length }, { "z1", Quantity::Length }, { "z2", Quantity::Length },
      { "a", Quantity::None }, { "href", Quantity::Length }, { "k_c", Quantity::None } },
    false, OceanDoubleSigma },
};
} // namespace

const vtkStratusFormula* vtkStratusFormula::Find(const std::string& standard_name, const std::map<std::string, std::string>& terms)
{
  const vtkStratusFormula* found = nullptr;
  for (const vtkStratusFormula& one : Formulas) {
    if (standard_name != one.Name) {
      continue;
    }
    const bool whole = std::all_of(
      std::begin(one.Terms), std::end(one.Terms), [&terms](const Term& term) { return !term.Name || terms.count(term.Name) > 0; });
    if (whole) {
      return &one;
    }
    found = found ? found : &one;
  }
  return found;
}

std::map<std::string, std::string> vtkStratusFormula::ReadTerms(const std::string& text)
{
  std::string spaced; // writers put blanks before the colon, behind it, or none
  for (char c : text) {
    spaced += c == ':' ? std::string(" : ") : std::string(1, c);
  }
  const std::vector<std::string> words = vtkStratusWords(spaced);
  std::map<std::string, std::string> terms;
  for (size_t i = 0; i + 2 < words.size(); ++i) {
    if (words[i + 1] == ":") {
      terms[words[i]] = words[i + 2];
    }
  }
  return terms;
}

bool vtkStratusIsDown(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFModel::Variable& variable)
{
  const std::string positive = file.Text(variable, "positive"), way = vtkStratusLowerCase(vtkStratusTrimmed(positive));
  if (way == "down" || way == "up") {
    return way == "down";
  }
  if (!way.empty()) {
    file.Fail("coordinate '" + variable.Name + "' has positive '" + positive + "', it must be up or down");
  }
  const std::string name = vtkStratusLowerCase(vtkStratusTrimmed(file.Text(variable, "standard_name")));
  if (!name.empty()) {
    return name == "depth" || name.compare(0, 6, "depth_") == 0;
  }
  if (vtkStratusLowerCase(vtkStratusTrimmed(variable.Name)).compare(0, 5, "depth") != 0 || variable.Dimensions.empty()) {
    return false;
  }
  std::vector<size_t> start(variable.Dimensions.size(), 0), count;
  for (int dimension : variable.Dimensions) {
    count.push_back(!count.empty() || variable.Dimensions.size() == 1 ? file.LengthOf(dimension) : 1);
  }
  const vtkSmartPointer<vtkDataArray> values = file.Read(variable, start, count);
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
    if (values->GetComponent(i, 0) < 0.0) {
      return false;
    }
  }
  return true;
}

double vtkStratusHeightOfPressure(double pressure)
{
  double height = 0.0;
  stratus_air_heights(1, &pressure, &height, nullptr);
  return height;
}

double vtkStratusTemperatureOfPressure(double pressure)
{
  double temperature = 0.0;
  stratus_air_heights(1, &pressure, nullptr, &temperature);
  return temperature;
}

double vtkStratusThickness(double temperature, double below, double above)
{
  return GasConstant / vtkStratusGravity * temperature * std::log(below / above);
}

double vtkStratusHeightInSea(double pressure)
{
  return -pressure / (SeaDensity * vtkStratusGravity);
}
