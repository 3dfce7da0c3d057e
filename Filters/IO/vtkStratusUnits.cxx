// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusUnits.h"
#include "vtkStratusText.h"

#include <algorithm>

#ifdef STRATUS_UDUNITS
#include <mutex>
#include <udunits2.h>
#endif

namespace {
// What UDUNITS does not read as the files mean it: "mb" is a millibarn there, symbols have one case, and "gpm" has no entry. Without
// UDUNITS these are all units.
constexpr struct {
  const char* Name;
  vtkStratusQuantity Quantity;
  double Scale, Offset;
} Known[] = {
  { "m", vtkStratusQuantity::Length, 1.0, 0.0 },
  { "meter", vtkStratusQuantity::Length, 1.0, 0.0 },
  { "meters", vtkStratusQuantity::Length, 1.0, 0.0 },
  { "metre", vtkStratusQuantity::Length, 1.0, 0.0 },
  { "metres", vtkStratusQuantity::Length, 1.0, 0.0 },
  { "gpm", vtkStratusQuantity::Length, 1.0, 0.0 },
  { "km", vtkStratusQuantity::Length, 1000.0, 0.0 },
  { "kilometer", vtkStratusQuantity::Length, 1000.0, 0.0 },
  { "kilometers", vtkStratusQuantity::Length, 1000.0, 0.0 },
  { "kilometre", vtkStratusQuantity::Length, 1000.0, 0.0 },
  { "kilometres", vtkStratusQuantity::Length, 1000.0, 0.0 },
  { "cm", vtkStratusQuantity::Length, 0.01, 0.0 },
  { "mm", vtkStratusQuantity::Length, 0.001, 0.0 },
  { "um", vtkStratusQuantity::Length, 1e-6, 0.0 },
  { "pa", vtkStratusQuantity::Pressure, 1.0, 0.0 },
  { "pascal", vtkStratusQuantity::Pressure, 1.0, 0.0 },
  { "hpa", vtkStratusQuantity::Pressure, 100.0, 0.0 },
  { "mb", vtkStratusQuantity::Pressure, 100.0, 0.0 },
  { "mbar", vtkStratusQuantity::Pressure, 100.0, 0.0 },
  { "millibar", vtkStratusQuantity::Pressure, 100.0, 0.0 },
  { "millibars", vtkStratusQuantity::Pressure, 100.0, 0.0 },
  { "dbar", vtkStratusQuantity::Pressure, 10000.0, 0.0 },
  { "k", vtkStratusQuantity::Temperature, 1.0, 0.0 },
  { "kelvin", vtkStratusQuantity::Temperature, 1.0, 0.0 },
  { "degc", vtkStratusQuantity::Temperature, 1.0, 273.15 },
  { "celsius", vtkStratusQuantity::Temperature, 1.0, 273.15 },
  { "degree", vtkStratusQuantity::Angle, 1.0, 0.0 },
  { "degrees", vtkStratusQuantity::Angle, 1.0, 0.0 },
  { "radian", vtkStratusQuantity::Angle, 57.29577951308232, 0.0 },
  { "radians", vtkStratusQuantity::Angle, 57.29577951308232, 0.0 },
};

// Returns whether the unit is "degree" or "degrees", then perhaps "_", then the word or its first letter.
bool IsDegreesOf(const std::string& units, const std::string& word)
{
  const std::string text = vtkStratusLowerCase(vtkStratusTrimmed(units));
  if (text.compare(0, 6, "degree") != 0) {
    return false;
  }
  size_t at = 6;
  at += at < text.size() && text[at] == 's' ? 1 : 0;
  at += at < text.size() && text[at] == '_' ? 1 : 0;
  const std::string rest = text.substr(at);
  return rest == word || rest == word.substr(0, 1);
}

#ifdef STRATUS_UDUNITS
// The library's tables, which are read once and never released. Its parser has global state, hence the lock.
class Library
{
public:
  Library()
  {
    ut_set_error_message_handler(ut_ignore);
    this->System = ut_read_xml(nullptr);
    const char* const names[] = { "m", "degree", "Pa", "K", "m2 s-2" };
    for (int i = 0; this->System && i < 5; ++i) {
      this->Units[i] = ut_parse(this->System, names[i], UT_UTF8);
    }
  }

  bool Find(const std::string& text, vtkStratusUnit& result)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    ut_unit* unit = this->System ? ut_parse(this->System, text.c_str(), UT_UTF8) : nullptr;
    const vtkStratusQuantity quantities[] = { vtkStratusQuantity::Length, vtkStratusQuantity::Angle, vtkStratusQuantity::Pressure,
      vtkStratusQuantity::Temperature, vtkStratusQuantity::Length };
    bool found = false;
    for (int i = 0; unit && !found && i < 5; ++i) {
      found =
        this->Units[i] && ut_are_convertible(unit, this->Units[i]) && (i != 1 || IsAngle(unit)) && Convert(unit, this->Units[i], result);
      if (found) {
        result.Quantity = quantities[i];
        result.Scale /= i == 4 ? vtkStratusGravity : 1.0;
      }
    }
    ut_free(unit);
    return found;
  }

private:
  static bool Convert(ut_unit* from, ut_unit* to, vtkStratusUnit& result)
  {
    cv_converter* converter = ut_get_converter(from, to);
    if (converter) {
      result.Offset = cv_convert_double(converter, 0.0);
      result.Scale = cv_convert_double(converter, 1.0) - result.Offset;
    }
    cv_free(converter);
    return converter != nullptr;
  }

  // UDUNITS converts plain numbers to angles, too, but distinguishes them in the parts of a unit.
  static bool IsAngle(ut_unit* unit)
  {
    char text[256];
    const int length = ut_format(unit, text, sizeof text, UT_ASCII | UT_DEFINITION);
    return length > 0 && std::string(text, std::min(static_cast<size_t>(length), sizeof text)).find("rad") != std::string::npos;
  }

  std::mutex Mutex;
  ut_system* System = nullptr;
  ut_unit* Units[5] = { nullptr, nullptr, nullptr, nullptr, nullptr };
};
#endif
} // namespace

bool vtkStratusIsEast(const std::string& units)
{
  return IsDegreesOf(units, "east");
}

bool vtkStratusIsNorth(const std::string& units)
{
  return IsDegreesOf(units, "north");
}

vtkStratusUnit vtkStratusUnitOf(const std::string& text)
{
  vtkStratusUnit result;
  const std::string lower = vtkStratusLowerCase(vtkStratusTrimmed(text));
  if (lower.empty()) {
    return result;
  }
#ifdef STRATUS_UDUNITS
  static Library* const library = new Library; // never destroyed: a reader may outlive static objects
  if (library->Find(text, result)) {
    return result;
  }
#endif
  for (const auto& known : Known) {
    if (lower == known.Name) {
      result.Quantity = known.Quantity;
      result.Scale = known.Scale;
      result.Offset = known.Offset;
      return result;
    }
  }
  result.Quantity = vtkStratusIsEast(text) || vtkStratusIsNorth(text) ? vtkStratusQuantity::Angle : vtkStratusQuantity::None;
  return result;
}

double vtkStratusMetresOf(const std::string& text)
{
  const vtkStratusUnit unit = vtkStratusUnitOf(text);
  return unit.IsLength() && unit.Scale > 0.0 ? unit.Scale : 0.0;
}
