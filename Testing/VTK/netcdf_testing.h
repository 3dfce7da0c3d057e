// SPDX-License-Identifier: BSD-3-Clause
// Helpers for tests of netCDF readers: write a file with libnetcdf itself.
#pragma once

#include "reading_testing.h"

#include <cstdlib>
#include <map>
#include <netcdf.h>
#include <string>
#include <vector>

struct netcdf_variable {
  std::string name;
  nc_type type;
  std::vector<std::string> dimensions;
  std::vector<double> values;
  std::map<std::string, std::string> texts;
  std::map<std::string, double> numbers; // of the variable's type, but scale_factor and add_offset, which are doubles
};

struct netcdf_content {
  std::vector<std::pair<std::string, size_t>> dimensions;
  std::vector<netcdf_variable> variables;

  netcdf_variable& of(const std::string& name)
  {
    for (netcdf_variable& one : this->variables) {
      if (one.name == name) {
        return one;
      }
    }
    std::abort();
  }
};

static void must(int status)
{
  if (status != NC_NOERR) {
    std::printf("the test's own file: %s\n", nc_strerror(status));
    std::exit(1);
  }
}

static std::string write_netcdf(const std::string& path, const netcdf_content& content, int format = NC_NETCDF4)
{
  int file = -1;
  must(nc_create(path.c_str(), format | NC_CLOBBER, &file));
  std::map<std::string, int> numbers;
  for (const auto& dimension : content.dimensions) {
    const bool record = dimension.first == "time" && format != NC_NETCDF4;
    must(nc_def_dim(file, dimension.first.c_str(), record ? NC_UNLIMITED : dimension.second, &numbers[dimension.first]));
  }
  std::vector<int> ids;
  for (const netcdf_variable& one : content.variables) {
    std::vector<int> of;
    for (const std::string& name : one.dimensions) {
      of.push_back(numbers.at(name));
    }
    int id = -1;
    must(nc_def_var(file, one.name.c_str(), one.type, static_cast<int>(of.size()), of.data(), &id));
    ids.push_back(id);
    for (const auto& text : one.texts) {
      must(nc_put_att_text(file, id, text.first.c_str(), text.second.size(), text.second.c_str()));
    }
    for (const auto& number : one.numbers) {
      const bool packing = number.first == "scale_factor" || number.first == "add_offset";
      must(nc_put_att_double(file, id, number.first.c_str(), packing ? NC_DOUBLE : one.type, 1, &number.second));
    }
  }
  must(nc_enddef(file));
  for (size_t i = 0; i < ids.size(); ++i) {
    if (!content.variables[i].values.empty()) {
      std::vector<size_t> start, count;
      for (const std::string& name : content.variables[i].dimensions) {
        start.push_back(0);
        for (const auto& dimension : content.dimensions) {
          if (dimension.first == name) {
            count.push_back(dimension.second);
          }
        }
      }
      const size_t none = 0;
      must(nc_put_vara_double(
        file, ids[i], start.empty() ? &none : start.data(), count.empty() ? &none : count.data(), content.variables[i].values.data()));
    }
  }
  must(nc_close(file));
  return path;
}
