// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFValues.h"

#include "vtkStratusMakeArray.h"
#include "vtkStratusText.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

// Stored values that are missing: these, and all outside of Low..High.
template <class Stored> struct vtkStratusNetCDFValues::Missing {
  std::vector<Stored> Values;
  Stored Low, High;
  bool All = false;

  // Sets for each of `count` values whether it is missing. Returns whether one is.
  bool Find(const Stored* values, size_t count, unsigned char* is_missing) const
  {
    unsigned char any = 0;
    for (size_t i = 0; i < count; ++i) {
      is_missing[i] = static_cast<unsigned char>(this->All | (values[i] < this->Low) | (values[i] > this->High));
    }
    for (const Stored value : this->Values) {
      for (size_t i = 0; i < count; ++i) {
        is_missing[i] |= static_cast<unsigned char>(values[i] == value);
      }
    }
    for (size_t i = 0; i < count; ++i) {
      any |= is_missing[i];
    }
    return any != 0;
  }
};

namespace {
constexpr struct {
  int Signed, Unsigned;
} Pairs[] = { { vtkStratusNetCDFInt8, vtkStratusNetCDFUInt8 }, { vtkStratusNetCDFInt16, vtkStratusNetCDFUInt16 },
  { vtkStratusNetCDFInt32, vtkStratusNetCDFUInt32 }, { vtkStratusNetCDFInt64, vtkStratusNetCDFUInt64 } };

// The default fill value of a type in the file, by the format's specification. Its bits are kept if `Stored` has the other sign.
template <class Stored> Stored DefaultFillOf(int type)
{
  switch (type) {
    case vtkStratusNetCDFInt16:
      return static_cast<Stored>(-32767);
    case vtkStratusNetCDFUInt16:
      return static_cast<Stored>(65535);
    case vtkStratusNetCDFInt32:
      return static_cast<Stored>(-2147483647);
    case vtkStratusNetCDFUInt32:
      return static_cast<Stored>(4294967295U);
    case vtkStratusNetCDFInt64:
      return static_cast<Stored>(INT64_C(-9223372036854775806));
    case vtkStratusNetCDFUInt64:
      return static_cast<Stored>(UINT64_C(18446744073709551614));
    default: // 15 * 2^119, of floats and doubles
      return static_cast<Stored>(9.9692099683868690e+36);
  }
}

// Converts a real to the stored type. Returns false if the type does not hold it. A type without sign takes a negative one by its bits.
template <class Stored> bool Convert(double real, Stored& value)
{
  using limits = std::numeric_limits<Stored>;
  if (std::is_floating_point<Stored>::value) {
    value = static_cast<Stored>(real);
    return true;
  }
  const double above = std::ldexp(1.0, limits::digits); // the least number that is too large
  if (real != std::floor(real) || real >= above || real < (limits::is_signed ? -above : -0.5 * above)) {
    return false;
  }
  value = real < 0.0 ? static_cast<Stored>(static_cast<std::int64_t>(real)) : static_cast<Stored>(real);
  return true;
}

// Calls `work` with a value of the C type of a stored type of numbers.
template <class Work> auto WithType(int type, const Work& work)
{
  switch (type) {
    case vtkStratusNetCDFInt8:
      return work(std::int8_t());
    case vtkStratusNetCDFUInt8:
      return work(std::uint8_t());
    case vtkStratusNetCDFInt16:
      return work(std::int16_t());
    case vtkStratusNetCDFUInt16:
      return work(std::uint16_t());
    case vtkStratusNetCDFInt32:
      return work(std::int32_t());
    case vtkStratusNetCDFUInt32:
      return work(std::uint32_t());
    case vtkStratusNetCDFInt64:
      return work(std::int64_t());
    case vtkStratusNetCDFUInt64:
      return work(std::uint64_t());
    case vtkStratusNetCDFFloat32:
      return work(float());
    default:
      return work(double());
  }
}

// Converts number i of an attribute to the stored type. Returns false if the type does not hold it.
template <class Stored> bool As(const vtkStratusNetCDFAttribute& attribute, size_t i, Stored& value)
{
  if (!attribute.Integers.empty() && (std::is_floating_point<Stored>::value || sizeof(Stored) == sizeof(std::int64_t))) {
    value = static_cast<Stored>(attribute.Integers[i]);
    return true;
  }
  return Convert(attribute.Reals[i], value);
}

template <class Value> constexpr int TypeOf()
{
  return std::is_same<Value, float>::value ? VTK_FLOAT
    : std::is_same<Value, double>::value   ? VTK_DOUBLE
    : sizeof(Value) == 1                   ? (std::is_signed<Value>::value ? VTK_SIGNED_CHAR : VTK_UNSIGNED_CHAR)
    : sizeof(Value) == 2                   ? (std::is_signed<Value>::value ? VTK_SHORT : VTK_UNSIGNED_SHORT)
    : sizeof(Value) == 4                   ? (std::is_signed<Value>::value ? VTK_INT : VTK_UNSIGNED_INT)
                                           : (std::is_signed<Value>::value ? VTK_LONG_LONG : VTK_UNSIGNED_LONG_LONG);
}
} // namespace

double vtkStratusNetCDFValues::NumberOf(const char* name, const Attribute& attribute, double otherwise) const
{
  if (attribute.Length == 0) {
    return otherwise;
  }
  if (attribute.IsText || attribute.Reals.size() != 1 || !std::isfinite(attribute.Reals[0])) {
    throw std::string(name) + " of '" + this->Name + "' is " +
      (attribute.IsText                 ? "text"
          : attribute.Reals.size() != 1 ? std::to_string(attribute.Reals.size()) + " numbers"
                                        : vtkStratusNumberText(attribute.Reals[0])) +
      ", it must be one finite number";
  }
  return attribute.Reals[0];
}

vtkStratusNetCDFValues::vtkStratusNetCDFValues(
  const std::function<Attribute(const char* name)>& attributes, int type, const std::string& name, bool default_fill, bool keeps_integers)
    : FileType(type), Type(type), Name(name), Fill(attributes("_FillValue")), MissingValue(attributes("missing_value")),
      DefaultFill(default_fill)
{
  this->Scale = this->NumberOf("scale_factor", attributes("scale_factor"), 1.0);
  this->Offset = this->NumberOf("add_offset", attributes("add_offset"), 0.0);
  // valid_range comes before valid_min and valid_max.
  const Attribute range = attributes("valid_range");
  const Attribute ends[] = { attributes("valid_min"), attributes("valid_max") };
  for (size_t i = 0; i < 2; ++i) {
    const bool one = range.IsText || range.Reals.size() != 2;
    this->LimitNames[i] = !one ? "valid_range" : i == 0 ? "valid_min" : "valid_max";
    if (one && ends[i].Reals.size() == 1) {
      this->Limits[i] = ends[i];
    } else if (!one) {
      this->Limits[i].Reals = { range.Reals[i] };
      this->Limits[i].Integers = range.Integers.empty() ? range.Integers : std::vector<std::int64_t>{ range.Integers[i] };
    }
  }
  const std::string is_unsigned = vtkStratusLowerCase(attributes("_Unsigned").Text);
  const std::vector<double>& upper = this->Limits[1].Reals;
  const bool beyond = !upper.empty() && type == vtkStratusNetCDFInt8 && upper[0] > 127.0 && upper[0] <= 255.0;
  for (const auto& pair : Pairs) {
    if (type == pair.Signed && (is_unsigned == "true" || (is_unsigned.empty() && beyond))) {
      this->Type = pair.Unsigned;
    } else if (type == pair.Unsigned && is_unsigned == "false") {
      this->Type = pair.Signed;
    }
  }
  const std::pair<const char*, const Attribute*> numbers[] = { { "_FillValue", &this->Fill }, { "missing_value", &this->MissingValue },
    { "valid_range", &range }, { "valid_min", &ends[0] }, { "valid_max", &ends[1] } };
  for (const auto& one : numbers) {
    if (one.second->IsText && one.second->Length > 0) {
      this->TextIgnored += std::string("; ") + one.first + " is text and ignored";
    }
  }
  const bool is_integer = type != vtkStratusNetCDFFloat32 && type != vtkStratusNetCDFFloat64;
  this->KeepsType = keeps_integers && is_integer && !this->IsPacked() && this->Fill.Reals.empty() && this->MissingValue.Reals.empty() &&
    this->Limits[0].Reals.empty() && this->Limits[1].Reals.empty();
}

std::string vtkStratusNetCDFValues::Describe() const
{
  std::string text = this->TextIgnored;
  for (size_t i = 0; i < 2; ++i) {
    const Attribute& limit = this->Limits[i];
    if (!limit.Reals.empty() && !this->IsUsed(limit)) {
      text += "; " + this->LimitNames[i] + " " + vtkStratusNumberText(limit.Reals[0]) + " is no packed value and ignored";
    }
  }
  return text;
}

// Limits are of packed values. One that the packed type does not hold was meant otherwise.
bool vtkStratusNetCDFValues::IsUsed(const Attribute& limit) const
{
  return !this->IsPacked() || WithType(this->Type, [&limit](auto value) { return As(limit, 0, value); });
}

// Looks up which stored values are missing.
template <class Stored> vtkStratusNetCDFValues::Missing<Stored> vtkStratusNetCDFValues::FindMissing() const
{
  using limits = std::numeric_limits<Stored>;
  Missing<Stored> result = { {}, limits::lowest(), limits::max() };
  if (limits::has_infinity) {
    result.Low = -limits::infinity();
    result.High = limits::infinity();
  }
  for (const Attribute* values : { &this->Fill, &this->MissingValue }) {
    for (size_t i = 0; i < values->Reals.size(); ++i) {
      Stored value = 0;
      if (As(*values, i, value)) {
        result.Values.push_back(value);
      }
    }
  }
  if (this->DefaultFill && this->Fill.Reals.empty() && sizeof(Stored) > 1) {
    result.Values.push_back(DefaultFillOf<Stored>(this->FileType));
  }
  for (size_t i = 0; i < 2; ++i) {
    const Attribute& limit = this->Limits[i];
    if (limit.Reals.empty() || !this->IsUsed(limit)) {
      continue;
    }
    Stored& bound = i == 0 ? result.Low : result.High;
    Stored value = 0;
    if (As(limit, 0, value)) {
      bound = value;
    } else { // of an integer that is not packed: between two values, or beyond all
      const double real = i == 0 ? std::ceil(limit.Reals[0]) : std::floor(limit.Reals[0]);
      const bool above = real > static_cast<double>(limits::max()), below = real < static_cast<double>(limits::lowest());
      bound = above ? limits::max() : below ? limits::lowest() : static_cast<Stored>(real);
      result.All = result.All || (i == 0 ? above : below);
    }
  }
  return result;
}

// Returns whether floats represent all unpacked values exactly: true for values of 8 and 16 bits, unless the offset uses up their digits,
// and for floats.
template <class Stored> bool vtkStratusNetCDFValues::IsFloatEnough() const
{
  if (std::is_floating_point<Stored>::value || sizeof(Stored) > 2) {
    return std::is_same<Stored, float>::value && !this->IsPacked();
  }
  using limits = std::numeric_limits<Stored>;
  const double largest =
    std::max(std::fabs(limits::lowest() * this->Scale + this->Offset), std::fabs(limits::max() * this->Scale + this->Offset));
  return largest < 1e38 && largest * std::numeric_limits<float>::epsilon() < 0.5 * std::fabs(this->Scale);
}

// Values are unpacked in parts that are short enough for a cache, by loops without branches.
template <class Stored, class Result> void vtkStratusNetCDFValues::ReadAs(size_t count, const Reader& read, Result* results) const
{
  constexpr size_t most = 1024;
  constexpr bool in_place = std::is_same<Stored, Result>::value;
  const std::unique_ptr<Stored[]> apart(in_place ? nullptr : new Stored[count]);
  void* const buffer = in_place ? static_cast<void*>(results) : static_cast<void*>(apart.get());
  read(buffer);
  const Stored* const stored = static_cast<const Stored*>(buffer);
  const Missing<Stored> missing = this->FindMissing<Stored>();
  const double scale = this->Scale, offset = this->Offset;
  unsigned char is_missing[most];
  for (size_t first = 0; first < count; first += most) {
    const Stored* const from = stored + first;
    Result* const to = results + first;
    const size_t part = std::min(most, count - first);
    const bool any = missing.Find(from, part, is_missing);
    if (this->IsPacked()) {
      for (size_t i = 0; i < part; ++i) {
        to[i] = static_cast<Result>(static_cast<double>(from[i]) * scale + offset);
      }
    } else if (!in_place) {
      std::copy_n(from, part, to);
    }
    for (size_t i = 0; any && i < part; ++i) {
      to[i] = is_missing[i] ? static_cast<Result>(NAN) : to[i];
    }
  }
}

int vtkStratusNetCDFValues::GetResultType() const
{
  return WithType(this->Type, [this](auto value) {
    using Stored = decltype(value);
    return this->KeepsType ? TypeOf<Stored>() : this->IsFloatEnough<Stored>() ? VTK_FLOAT : VTK_DOUBLE;
  });
}

void vtkStratusNetCDFValues::ReadInto(size_t count, const Reader& read, void* results) const
{
  if (this->KeepsType) {
    read(results);
    return;
  }
  WithType(this->Type, [&](auto value) {
    using Stored = decltype(value);
    if (this->IsFloatEnough<Stored>()) {
      this->ReadAs<Stored>(count, read, static_cast<float*>(results));
    } else {
      this->ReadAs<Stored>(count, read, static_cast<double*>(results));
    }
  });
}

vtkSmartPointer<vtkDataArray> vtkStratusNetCDFValues::Read(size_t count, const Reader& read) const
{
  const vtkSmartPointer<vtkDataArray> array = vtkStratusMakeArray(this->GetResultType(), 1, static_cast<vtkIdType>(count));
  this->ReadInto(count, read, array->GetVoidPointer(0));
  return array;
}
