// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFValues.h"
#include "vtkStratusText.h"

#include "vtkStratusNetCDFFile.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <netcdf.h>
#include <numeric>
#include <type_traits>

// The numbers of an attribute. Integers of 64 bits stay exact.
struct vtkStratusNetCDFValues::Attribute {
  bool Exists = false, IsText = false;
  std::vector<double> Reals;
  std::vector<std::int64_t> Integers; // empty for reals; an unsigned one above the largest has its bits

  // Converts number i to the stored type. Returns false if the type does not hold it.
  template <class Stored> bool As(size_t i, Stored& value) const;
};

// Stored values that are missing: these, and all outside of Low..High.
template <class Stored> struct vtkStratusNetCDFValues::Missing {
  std::vector<Stored> Values;
  Stored Low, High;
  bool All = false;

  bool Has(Stored value) const
  {
    return this->All || value < this->Low || value > this->High ||
      std::find(this->Values.begin(), this->Values.end(), value) != this->Values.end();
  }
};

namespace {
constexpr struct {
  int Signed, Unsigned, Bytes;
} Pairs[] = { { NC_BYTE, NC_UBYTE, 1 }, { NC_SHORT, NC_USHORT, 2 }, { NC_INT, NC_UINT, 4 }, { NC_INT64, NC_UINT64, 8 } };

std::string ReadText(int file, int variable, const char* name)
{
  nc_type type = NC_NAT;
  size_t length = 0;
  if (nc_inq_att(file, variable, name, &type, &length) != NC_NOERR || (type != NC_CHAR && type != NC_STRING)) {
    return "";
  }
  std::string text;
  if (type == NC_CHAR) {
    text.resize(length);
    text.resize(nc_get_att_text(file, variable, name, &text[0]) == NC_NOERR ? length : 0);
  } else if (length > 0) {
    std::vector<char*> strings(length, nullptr);
    if (nc_get_att_string(file, variable, name, strings.data()) == NC_NOERR) {
      text = strings[0] ? strings[0] : "";
      nc_free_string(length, strings.data());
    }
  }
  return vtkStratusLowerCase(text.substr(0, text.find('\0')));
}

// The default fill value of a type in the file. Its bits are kept if `Stored` has the other sign.
template <class Stored> Stored DefaultFill(int type)
{
  switch (type) {
    case NC_SHORT:
      return static_cast<Stored>(NC_FILL_SHORT);
    case NC_USHORT:
      return static_cast<Stored>(NC_FILL_USHORT);
    case NC_INT:
      return static_cast<Stored>(NC_FILL_INT);
    case NC_UINT:
      return static_cast<Stored>(NC_FILL_UINT);
    case NC_INT64:
      return static_cast<Stored>(NC_FILL_INT64);
    case NC_UINT64:
      return static_cast<Stored>(NC_FILL_UINT64);
    case NC_FLOAT:
      return static_cast<Stored>(NC_FILL_FLOAT);
    default:
      return static_cast<Stored>(NC_FILL_DOUBLE);
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

// Calls `work` with a value of the C type of an nc_type of numbers.
template <class Work> auto WithType(int type, const Work& work)
{
  switch (type) {
    case NC_BYTE:
      return work(std::int8_t());
    case NC_UBYTE:
      return work(std::uint8_t());
    case NC_SHORT:
      return work(std::int16_t());
    case NC_USHORT:
      return work(std::uint16_t());
    case NC_INT:
      return work(std::int32_t());
    case NC_UINT:
      return work(std::uint32_t());
    case NC_INT64:
      return work(std::int64_t());
    case NC_UINT64:
      return work(std::uint64_t());
    case NC_FLOAT:
      return work(float());
    default:
      return work(double());
  }
}
} // namespace

template <class Stored> bool vtkStratusNetCDFValues::Attribute::As(size_t i, Stored& value) const
{
  if (!this->Integers.empty() && (std::is_floating_point<Stored>::value || sizeof(Stored) == sizeof(std::int64_t))) {
    value = static_cast<Stored>(this->Integers[i]);
    return true;
  }
  return Convert(this->Reals[i], value);
}

vtkStratusNetCDFValues::Attribute vtkStratusNetCDFValues::ReadAttribute(const char* name) const
{
  Attribute result;
  nc_type type = NC_NAT;
  size_t length = 0;
  if (nc_inq_att(this->File, this->Variable, name, &type, &length) != NC_NOERR || length == 0) {
    return result;
  }
  result.Exists = true;
  result.IsText = type == NC_CHAR || type >= NC_STRING;
  if (result.IsText) {
    return result;
  }
  result.Reals.resize(length);
  nc_get_att_double(this->File, this->Variable, name, result.Reals.data());
  if (type == NC_UINT64) {
    std::vector<unsigned long long> bits(length);
    nc_get_att_ulonglong(this->File, this->Variable, name, bits.data());
    std::transform(bits.begin(), bits.end(), std::back_inserter(result.Integers), [](auto one) { return static_cast<std::int64_t>(one); });
  } else if (type != NC_FLOAT && type != NC_DOUBLE) {
    std::vector<long long> integers(length);
    nc_get_att_longlong(this->File, this->Variable, name, integers.data());
    result.Integers.assign(integers.begin(), integers.end());
  }
  return result;
}

double vtkStratusNetCDFValues::ReadNumber(const char* attribute, double otherwise) const
{
  const Attribute found = this->ReadAttribute(attribute);
  if (!found.Exists) {
    return otherwise;
  }
  if (found.IsText || found.Reals.size() != 1 || !std::isfinite(found.Reals[0])) {
    throw std::string(attribute) + " of '" + this->Name + "' is " +
      (found.IsText                 ? "text"
          : found.Reals.size() != 1 ? std::to_string(found.Reals.size()) + " numbers"
                                    : vtkStratusNumberText(found.Reals[0])) +
      ", it must be one finite number";
  }
  return found.Reals[0];
}

// The lower (index 0) or upper limit of valid values. valid_range comes before valid_min and valid_max.
vtkStratusNetCDFValues::Attribute vtkStratusNetCDFValues::ReadLimit(size_t index, std::string& name) const
{
  name = "valid_range";
  Attribute range = this->ReadAttribute("valid_range");
  if (range.IsText || range.Reals.size() != 2) {
    name = index == 0 ? "valid_min" : "valid_max";
    range = this->ReadAttribute(name.c_str());
    return range.Reals.size() == 1 ? range : Attribute();
  }
  range.Reals = { range.Reals[index] };
  range.Integers = range.Integers.empty() ? range.Integers : std::vector<std::int64_t>{ range.Integers[index] };
  return range;
}

vtkStratusNetCDFValues::vtkStratusNetCDFValues(int file, int variable, int type, const std::string& name)
    : File(file), Variable(variable), FileType(type), Type(type), Name(name)
{
  this->Scale = this->ReadNumber("scale_factor", 1.0);
  this->Offset = this->ReadNumber("add_offset", 0.0);
  const std::string is_unsigned = ReadText(file, variable, "_Unsigned");
  std::string limit;
  const Attribute upper = this->ReadLimit(1, limit);
  const bool beyond = !upper.Reals.empty() && type == NC_BYTE && upper.Reals[0] > 127.0 && upper.Reals[0] <= 255.0;
  for (const auto& pair : Pairs) {
    if (type == pair.Signed && (is_unsigned == "true" || (is_unsigned.empty() && beyond))) {
      this->Type = pair.Unsigned;
    } else if (type == pair.Unsigned && is_unsigned == "false") {
      this->Type = pair.Signed;
    }
  }
}

std::string vtkStratusNetCDFValues::Describe() const
{
  std::string text;
  for (const char* name : { "_FillValue", "missing_value", "valid_range", "valid_min", "valid_max" }) {
    if (this->ReadAttribute(name).IsText) {
      text += std::string("; ") + name + " is text and ignored";
    }
  }
  for (size_t i = 0; i < 2; ++i) {
    std::string name;
    const Attribute limit = this->ReadLimit(i, name);
    if (!limit.Reals.empty() && !this->IsUsed(limit)) {
      text += "; " + name + " " + vtkStratusNumberText(limit.Reals[0]) + " is no packed value and ignored";
    }
  }
  return text;
}

// Limits are of packed values. One that the packed type does not hold was meant otherwise.
bool vtkStratusNetCDFValues::IsUsed(const Attribute& limit) const
{
  return !this->IsPacked() || WithType(this->Type, [&limit](auto value) { return limit.As(0, value); });
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
  const Attribute fill = this->ReadAttribute("_FillValue");
  for (const Attribute& values : { fill, this->ReadAttribute("missing_value") }) {
    for (size_t i = 0; i < values.Reals.size(); ++i) {
      Stored value = 0;
      if (values.As(i, value)) {
        result.Values.push_back(value);
      }
    }
  }
  int none = 0;
  if (fill.Reals.empty() && sizeof(Stored) > 1 && nc_inq_var_fill(this->File, this->Variable, &none, nullptr) == NC_NOERR && !none) {
    result.Values.push_back(DefaultFill<Stored>(this->FileType));
  }
  for (size_t i = 0; i < 2; ++i) {
    std::string name;
    const Attribute limit = this->ReadLimit(i, name);
    if (limit.Reals.empty() || !this->IsUsed(limit)) {
      continue;
    }
    Stored& bound = i == 0 ? result.Low : result.High;
    Stored value = 0;
    if (limit.As(0, value)) {
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

template <class Stored, class Result>
void vtkStratusNetCDFValues::Unpack(const Missing<Stored>& missing, const Stored* stored, size_t count, Result* results) const
{
  const bool packed = this->IsPacked();
  for (size_t i = 0; i < count; ++i) {
    const Stored value = stored[i];
    results[i] = missing.Has(value) ? static_cast<Result>(NAN)
      : packed                      ? static_cast<Result>(static_cast<double>(value) * this->Scale + this->Offset)
                                    : static_cast<Result>(value);
  }
}

template <class Stored, class Result>
vtkSmartPointer<vtkDataArray> vtkStratusNetCDFValues::ReadAs(
  const std::vector<size_t>& start, const std::vector<size_t>& count, int& status, std::unique_lock<std::recursive_mutex>* lock) const
{
  const size_t total = std::accumulate(count.begin(), count.end(), static_cast<size_t>(1), std::multiplies<size_t>());
  using Array = std::conditional_t<std::is_same<Result, float>::value, vtkFloatArray, vtkDoubleArray>;
  const vtkSmartPointer<Array> array = vtkSmartPointer<Array>::New();
  array->SetNumberOfValues(static_cast<vtkIdType>(total));
  Result* results = array->GetPointer(0);
  const size_t zero = 0, one = 1;
  std::vector<Stored> apart(std::is_same<Stored, Result>::value ? 0 : total); // reals are unpacked in place
  void* stored = std::is_same<Stored, Result>::value ? static_cast<void*>(results) : static_cast<void*>(apart.data());
  status = nc_get_vara(this->File, this->Variable, start.empty() ? &zero : start.data(), count.empty() ? &one : count.data(), stored);
  if (status != NC_NOERR) {
    return nullptr;
  }
  const Missing<Stored> missing = this->FindMissing<Stored>();
  if (lock) {
    lock->unlock();
  }
  this->Unpack(missing, static_cast<const Stored*>(stored), total, results);
  return array;
}

vtkSmartPointer<vtkDataArray> vtkStratusNetCDFValues::Read(
  const std::vector<size_t>& start, const std::vector<size_t>& count, int& status, std::unique_lock<std::recursive_mutex>* lock) const
{
  return WithType(this->Type, [&](auto value) {
    using Stored = decltype(value);
    return this->IsFloatEnough<Stored>() ? this->ReadAs<Stored, float>(start, count, status, lock)
                                         : this->ReadAs<Stored, double>(start, count, status, lock);
  });
}
