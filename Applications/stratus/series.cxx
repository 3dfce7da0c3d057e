// SPDX-License-Identifier: BSD-3-Clause
#include "series.h"

#include "nearest.h"
#include "reading.h"
#include "support.h"
#include "vtkStratusVariableReader.h"

#include <vtkCallbackCommand.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <set>
#include <sstream>
#include <sys/stat.h>
#include <utility>

namespace {

// Collects all messages of VTK. Readers also report through objects of their own (parsers, decompressors), whose messages pass here, too.
class listener : public vtkOutputWindow
{
public:
  static listener* New();
  vtkTypeMacro(listener, vtkOutputWindow);
  void DisplayText(const char* text) override { this->Heard += text ? text : ""; }
  std::string Heard;

protected:
  listener() = default;
};
vtkStandardNewMacro(listener);

// Collects messages during its lifetime, also from std::cerr, which is the only place where VTK's MetaIO reports a truncated file.
class listening
{
public:
  listening() : Before(vtkOutputWindow::GetInstance()), Stream(std::cerr.rdbuf(this->Text.rdbuf()))
  {
    vtkOutputWindow::SetInstance(this->Now);
  }
  ~listening()
  {
    vtkOutputWindow::SetInstance(this->Before);
    std::cerr.rdbuf(this->Stream);
  }
  listening(const listening&) = delete;
  listening& operator=(const listening&) = delete;
  std::string heard() const { return this->Now->Heard + this->Text.str(); }

private:
  vtkSmartPointer<vtkOutputWindow> Before;
  vtkNew<listener> Now;
  std::ostringstream Text;
  std::streambuf* Stream;
};

// Extracts the first message that says more than that a reader failed. VTK puts "ERROR: In file, line n\nvtkClass (0x..): " before each,
// and two ends of line behind it.
std::string first_message(const std::string& heard)
{
  std::string text;
  bool says_nothing = true;
  for (size_t begin = 0, end; says_nothing && begin < heard.size(); begin = end + 2) {
    end = std::min(heard.find("\n\n", begin), heard.size());
    text = heard.substr(begin, end - begin);
    const size_t at = text.find("): ");
    text = text.substr(at == std::string::npos ? 0 : at + 3);
    says_nothing = text.find("returned failure for request") != std::string::npos || text.find_first_not_of('\n') == std::string::npos;
  }
  if (says_nothing) {
    return "its reader cannot make sense of it: it is cut short, damaged, or of another kind than its name says";
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') {
    text.pop_back();
  }
  return text;
}

void check_file(const std::string& path)
{
  struct stat status;
  FILE* file = std::fopen(path.c_str(), "rb");
  const int reason = errno;
  if (!file) {
    throw cli::failure("cannot read '" + path + "': " + std::strerror(reason));
  }
  const bool folder = fstat(fileno(file), &status) == 0 && S_ISDIR(status.st_mode);
  std::fclose(file);
  if (folder && !cli::is_zarr(path)) {
    throw cli::failure("cannot read '" + path + "': it is a folder, and none of Zarr");
  }
}

// Prints a warning, each text once.
void print_warning(vtkObject*, unsigned long, void*, void* text)
{
  static std::set<std::string> printed;
  const std::string message = first_message(static_cast<const char*>(text));
  if (printed.insert(message).second) {
    std::fprintf(stderr, "stratus: warning: %s\n", message.c_str());
  }
}

// Watches a reader's work, and turns every complaint into a failure. Warnings of our own readers are only printed, because they are about
// files that can be drawn; a warning of VTK's readers means a damaged file.
class guard
{
public:
  explicit guard(const std::string& path) : Path(path), Watched(path, "VTK") {}

  template <class Work> void run(vtkAlgorithm* reader, const Work& work)
  {
    this->Watched.follow(reader);
    vtkNew<vtkCallbackCommand> warned;
    warned->SetCallback(print_warning);
    const bool ours = reader->IsA("vtkStratusVariableReader");
    const unsigned long observer = ours ? reader->AddObserver(vtkCommand::WarningEvent, warned) : 0;
    try {
      work();
    } catch (const std::bad_alloc&) {
      throw cli::failure("cannot read '" + this->Path + "': " + reader->GetClassName() + " wants more memory than there is");
    } catch (const std::exception& error) {
      throw cli::failure("cannot read '" + this->Path + "': " + reader->GetClassName() + " failed: " + error.what());
    }
    if (ours) {
      reader->RemoveObserver(observer);
    }
    const std::string heard = this->Listener.heard();
    if (!heard.empty()) {
      throw cli::failure("cannot read '" + this->Path + "': " + first_message(heard));
    }
  }

private:
  std::string Path;
  cli::reading Watched;
  listening Listener;
};
} // namespace

namespace cli {

void series::open()
{
  const std::string& path = this->Path;
  guard watch(path);
  check_file(path);
  if (is_collection(path)) {
    if (!this->Select.empty()) {
      throw usage("--select " + this->Select + ": '" + path + "' is a list of files, which has no dimensions with names");
    }
    if (this->Globe) {
      throw usage("--globe: '" + path + "' is a list of files, only netCDF and Zarr have longitudes and latitudes");
    }
    this->Parts = read_collection(path);
    for (const collection_step& step : this->Parts) {
      this->Times.push_back(step.time);
    }
    return;
  }
  const file_format found = choose_format(path, this->Raw);
  if (!found.reader) {
    throw failure("'" + path + "' is no image file that VTK reads (.vti .vtk .mha .mhd .nrrd .nhdr .nii .tif .png ...) " +
      "and no grid (.nc .zarr .vdb .vtr .vts .vtu .vtm .vthb .pvd .vtk .vtkhdf .foam .case .node .ele ...)");
  }
  this->Units = found.time_units;
  this->Reader = found.reader;
  if (!this->Select.empty()) {
    select_indices(this->Reader, this->Select);
  }
  if (this->Globe) {
    place_on_globe(this->Reader, this->HeightFactor);
  }
  watch.run(this->Reader, [this] {
    this->Reader->UpdateInformation();
    if (!this->Variable.empty() && has_variable(this->Reader, this->Variable)) {
      choose_variable(this->Reader, this->Variable);
      this->Reader->UpdateInformation();
    }
    this->Units += time_units_of(this->Reader);
    vtkInformation* information = this->Reader->GetOutputInformation(0);
    if (information && information->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS())) {
      const double* times = information->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
      this->Times.assign(times, times + information->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()));
    }
  });
}

series::series(const std::string& path, const reading_options& reading)
    : Path(path), Variable(reading.variable), Raw(reading.raw), Select(reading.select), Globe(reading.globe),
      HeightFactor(reading.height_factor)
{
  this->open();
  if (this->Reader && !this->Variable.empty() && !has_variable(this->Reader, this->Variable)) {
    std::string names;
    std::vector<std::string> known;
    const std::string wanted = std::exchange(this->Variable, "");
    for (const variable_entry& one : this->variables(0)) {
      names += (names.empty() ? "" : ", ") + one.name + " (" +
        (one.low <= one.high ? format("%g .. %g", one.low, one.high) : "nothing finite") + (one.units.empty() ? "" : " " + one.units) + ")";
      known.push_back(one.name);
    }
    const std::string near = meant(wanted, known);
    throw failure("no variable '" + wanted + "' on a grid of three dimensions in '" + path + "'" +
      (near.empty() ? "; those" : near + " Those") + " that are: " + names);
  }
  for (size_t i = 1; i < this->Times.size(); ++i) {
    if (!(this->Times[i] > this->Times[i - 1])) {
      throw failure("cannot read '" + path +
        "': " + format("its time does not increase: step %zu is at %.9g, after %.9g", i, this->Times[i], this->Times[i - 1]));
    }
  }
}

std::vector<variable_entry> series::variables(size_t step)
{
  std::vector<variable_entry> list;
  if (this->Reader) {
    guard watch(this->Path);
    watch.run(this->Reader, [&] { list = list_variables(this->Reader, this->Times.empty() ? 0.0 : this->Times[step]); });
    choose_variable(this->Reader, this->Variable);
  }
  return list;
}

std::vector<variable_name> series::names() const
{
  return this->Reader ? names_of_variables(this->Reader) : std::vector<variable_name>();
}

std::string series::choice() const
{
  return this->Reader ? choice_of(this->Reader) : "";
}

std::string series::calendar() const
{
  return this->Reader ? time_calendar_of(this->Reader) : "";
}

std::string series::grid() const
{
  return this->Reader ? description_of(this->Reader) : "";
}

vtkSmartPointer<vtkDataObject> series::read(size_t step)
{
  if (!this->Reader) {
    return this->read_parts(this->Parts[step]);
  }
  guard watch(this->Path);
  watch.run(this->Reader, [this, step] {
    if (this->Times.empty()) {
      this->Reader->Update();
    } else {
      this->Reader->UpdateTimeStep(this->Times[step]);
    }
  });
  return this->Reader->GetOutputDataObject(0);
}

bool series::reads_ahead() const
{
  vtkStratusVariableReader* const reader = vtkStratusVariableReader::SafeDownCast(this->Reader);
  return reader && reader->GetMapped();
}

vtkSmartPointer<vtkDataObject> series::read_parts(const collection_step& step)
{
  if (step.files.size() == 1) {
    return series(step.files[0]).read(0);
  }
  vtkNew<vtkMultiBlockDataSet> parts;
  for (const std::string& file : step.files) {
    parts->SetBlock(parts->GetNumberOfBlocks(), series(file).read(0));
  }
  return parts;
}

std::string series::time_of(size_t step) const
{
  if (this->Times.empty()) {
    return "";
  }
  const context core("host", 1);
  char text[STRATUS_TIME_TEXT];
  return stratus_time_write(core, this->Times[step], this->Units.c_str(), this->calendar().c_str(), text) == STRATUS_OK
    ? text
    : format("%.9g", this->Times[step]) + (this->Units.empty() ? "" : " " + this->Units);
}

std::string series::axis_name(int axis) const
{
  return this->Reader ? axis_name_of(this->Reader, axis) : "";
}

std::string series::axis_units(int axis) const
{
  return this->Reader ? axis_units_of(this->Reader, axis) : "";
}

std::string series::value_units() const
{
  return this->Reader ? value_units_of(this->Reader) : "";
}

data_about series::about() const
{
  data_about result;
  result.earth = this->Reader && is_netcdf(this->Reader);
  for (int axis = 0; axis < 3; ++axis) {
    result.earth = result.earth && this->axis_units(axis) == "m";
    result.axes[static_cast<size_t>(axis)] = this->Reader ? axis_about_of(this->Reader, axis) : axis_about();
  }
  if (this->Reader) {
    result.place = place_on_plane(this->Reader, result.why_no_place);
  }
  for (const variable_name& one : this->names()) {
    if (result.name.empty() && (this->Variable.empty() || one.name == this->Variable)) {
      result.name = one.name;
      result.standard_name = one.standard_name;
      result.units = one.units;
    }
  }
  return result;
}

double series::height_factor() const
{
  return this->Globe ? height_factor_of(this->Reader) : 0.0;
}

std::string series::describe(size_t step) const
{
  return this->Times.empty() ? "" : format("step %zu of %zu, at ", step, this->Times.size()) + this->time_of(step);
}

// Whether a text begins as a date does: digits, and a hyphen behind them.
bool series::is_moment(const std::string& time)
{
  const size_t behind = time.find_first_not_of("0123456789");
  return behind != std::string::npos && behind > 0 && time[behind] == '-';
}

double series::value_of_moment(const std::string& time) const
{
  const context core("host", 1);
  const std::string calendar = this->calendar();
  double value = 0.0;
  if (stratus_time_value(core, "2000-01-01", this->Units.c_str(), calendar.c_str(), &value) != STRATUS_OK) {
    throw usage("--time: '" + this->Path + "' has no times since a date" + (this->Units.empty() ? "" : " (it has '" + this->Units + "')") +
      ": give a number or step:N, not " + time);
  }
  if (stratus_time_value(core, time.c_str(), this->Units.c_str(), calendar.c_str(), &value) != STRATUS_OK) {
    throw usage("--time: " + std::string(stratus_context_message(core)));
  }
  return value;
}

// A number in the file's units, or with a unit of its own.
double series::value_of_time(const std::string& text) const
{
  size_t digits = text.size();
  while (digits > 0 && !std::isdigit(static_cast<unsigned char>(text[digits - 1])) && text[digits - 1] != '.') {
    --digits;
  }
  const size_t word = text.find_first_not_of(' ', digits);
  const double value = number(text.substr(0, digits), "--time");
  if (word == std::string::npos) {
    return value;
  }
  const double given = stratus_time_unit(text.c_str() + word), own = stratus_time_unit(this->Units.c_str());
  if (given == 0.0) {
    throw usage("--time: '" + text.substr(word) + "' is no unit of time: ms, s, min, h, d, weeks");
  }
  if (own == 0.0) {
    throw usage("--time: '" + this->Path + "' does not give the unit of its time (it has '" + this->Units + "'): give " + text +
      " as a number or as step:N");
  }
  return value * given / own;
}

size_t series::find(const std::string& time) const
{
  if (time.empty() || time == "first") {
    return 0;
  }
  if (time == "last") {
    return this->steps() - 1;
  }
  if (time.compare(0, 5, "step:") == 0) {
    return static_cast<size_t>(whole_number(time.substr(5), "--time", 0, static_cast<int>(this->steps()) - 1));
  }
  const bool after_first = time[0] == '+';
  double wanted = is_moment(time) ? this->value_of_moment(time) : this->value_of_time(time.substr(after_first ? 1 : 0));
  if (this->Times.empty()) {
    throw usage("--time: '" + this->Path + "' has no time");
  }
  wanted += after_first ? this->Times[0] : 0.0;
  const auto nearest = std::min_element(
    this->Times.begin(), this->Times.end(), [wanted](double a, double b) { return std::fabs(a - wanted) < std::fabs(b - wanted); });
  return static_cast<size_t>(nearest - this->Times.begin());
}
} // namespace cli
