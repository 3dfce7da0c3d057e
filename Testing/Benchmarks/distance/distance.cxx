// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench distance: times and errors of exact distance fields and of floodings, compared with ITK's, in one process.
#include "distance.h"
#include "bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>

namespace bench {

namespace {

const char* const help = R"(stratus-bench distance [options]

  --case NAME,...     sparse, clustered, dense, single, none, all, plate, shell (default: all of them)
  --size N,...        voxels along each axis (default 64,128,256)
  --method M,...      stratus:exact|zigzag|envelope|jfa|jfa+1|jfa+2|1+jfa|jfa2|ajfa|ajfa-fig5, with -signed and then @host or @device (the
                      first OpenCL device; where that is a CPU, the host builds) behind it; itk (signed). Default: all on the host, exact
                      signed too
  --threads N         of the host and of ITK (default 2)
  --csv FILE          tidy rows: benchmark,scene,method,metric,value,unit (default: the standard output)
                      the comments before them say where they come from, as in stratus-bench volume
  --append            rows of other scenes that the file has stay
  --chart FILE.png    build time against the share of wrong voxels, of the largest size

build_ms: from the set of voxels to the field, median of 7 (floodings and ITK beyond 128 voxels: 1). array_ms: the same, and all
distances as floats in new memory, which is what ITK's build_ms holds. cpu_ms: processor time of all threads in array_ms, for machines
that are busy. wrong_percent, max_error and rms_error (voxels): against brute force's equal, stratus:zigzag; unfilled voxels are wrong,
but in no other error. ITK's errors are measured against its own target, the contour.
)";

struct options {
  std::vector<std::string> cases, methods;
  std::vector<int64_t> sizes;
  std::string csv = "-", chart;
  int threads = 2;
  bool append = false;
};

struct closer {
  void operator()(stratus_context* c) const { stratus_context_destroy(c); }
  void operator()(stratus_voxels* v) const { stratus_voxels_destroy(v); }
  void operator()(stratus_field* f) const { stratus_field_destroy(f); }
};
using context_pointer = std::unique_ptr<stratus_context, closer>;
using voxels_pointer = std::unique_ptr<stratus_voxels, closer>;
using field_pointer = std::unique_ptr<stratus_field, closer>;

struct method {
  stratus_field_options field;
  bool on_device = false, is_itk = false;
};

bool cut(std::string& text, const std::string& end)
{
  const bool has = text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
  text.resize(text.size() - (has ? end.size() : 0));
  return has;
}

method parse_method(const std::string& name)
{
  method m;
  m.field = stratus_field_options_default();
  m.is_itk = name == "itk";
  std::string rest = name;
  m.on_device = cut(rest, "@device");
  cut(rest, "@host");
  m.field.is_signed = cut(rest, "-signed");
  for (int i = 0; i <= STRATUS_FIELD_AJFA_FIG5; ++i) {
    m.field.method = static_cast<stratus_field_method>(i);
    if (m.is_itk || rest == std::string("stratus:") + stratus_field_method_name(m.field.method)) {
      return m;
    }
  }
  throw failure("unknown method " + name + "; see --help");
}

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; i += 2) {
    const std::string word = argv[i];
    if (word == "--append") {
      o.append = true;
      --i;
      continue;
    }
    if (i + 1 == argc) {
      throw failure(word + " is unknown or lacks its value; see --help");
    }
    const std::string value = argv[i + 1];
    if (word == "--case") {
      o.cases = split(value);
    } else if (word == "--method") {
      o.methods = split(value);
    } else if (word == "--size") {
      for (const std::string& size : split(value)) {
        o.sizes.push_back(std::atoi(size.c_str()));
      }
    } else if (word == "--threads") {
      o.threads = std::atoi(value.c_str());
    } else if (word == "--csv") {
      o.csv = value;
    } else if (word == "--chart") {
      o.chart = value;
    } else {
      throw failure("unknown option " + word + "; see --help");
    }
  }
  o.sizes = o.sizes.empty() ? std::vector<int64_t>{ 64, 128, 256 } : o.sizes;
  o.cases = o.cases.empty() ? distance_case_names() : o.cases;
  if (o.methods.empty()) {
    o.methods = { "stratus:exact-signed", "stratus:exact", "stratus:zigzag", "stratus:envelope", "stratus:jfa", "stratus:jfa+1",
      "stratus:jfa+2", "stratus:1+jfa", "stratus:jfa2", "stratus:ajfa", "stratus:ajfa-fig5", "itk" };
  }
  for (const std::string& name : o.methods) {
    parse_method(name);
  }
  for (const int64_t size : o.sizes) {
    if (size < 8 || size > 1024) {
      throw failure("--size must be within 8..1024");
    }
  }
  if (o.threads < 1 || o.threads > 1024) {
    throw failure("--threads must be within 1..1024");
  }
  return o;
}

void check(const stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    throw failure(stratus_context_message(context));
  }
}

context_pointer open_context(const char* device, int threads)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = nullptr;
  char message[512];
  options.device = device;
  options.threads = threads;
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    throw failure(message);
  }
  return context_pointer(context);
}

voxels_pointer make_voxels(stratus_context* context, int64_t size, const std::vector<uint8_t>& effective)
{
  stratus_volume volume = stratus_volume_default();
  stratus_criterion criterion = stratus_criterion_default();
  stratus_voxels* voxels = nullptr;
  volume.values = effective.data();
  volume.type = STRATUS_UINT8;
  for (int a = 0; a < 3; ++a) {
    volume.dimensions[a] = size;
    volume.origin[a] = 0.0;
    volume.spacing[a] = 1.0;
  }
  criterion.lower = 1.0;
  criterion.upper = 1.0;
  check(context, stratus_voxels_create(context, &volume, &criterion, &voxels));
  return voxels_pointer(voxels);
}

std::vector<float> read_field(const stratus_field* field, size_t count)
{
  std::vector<float> distances(count);
  stratus_field_distances(field, distances.data());
  return distances;
}

std::vector<float> exact_distances(stratus_context* context, const stratus_voxels* voxels, int is_signed, size_t count)
{
  stratus_field_options options = stratus_field_options_default();
  stratus_field* field = nullptr;
  options.method = STRATUS_FIELD_ZIGZAG;
  options.is_signed = is_signed;
  check(context, stratus_field_create(context, voxels, &options, &field, nullptr));
  return read_field(field_pointer(field).get(), count);
}

struct judgement {
  double wrong_percent = 0.0, unfilled_percent = 0.0, max_error = 0.0, rms_error = 0.0;
};

judgement judge(const std::vector<float>& distances, const std::vector<float>& right, double tolerance)
{
  judgement j;
  size_t wrong = 0;
  size_t unfilled = 0;
  double squares = 0.0;
  for (size_t v = 0; v < right.size(); ++v) {
    if (std::isinf(right[v])) {
      wrong += std::fabs(distances[v]) < 1e3f; // ITK marks "none" by a large number
    } else if (std::isinf(distances[v])) {
      ++unfilled;
    } else {
      const double error = std::fabs(static_cast<double>(distances[v]) - static_cast<double>(right[v]));
      wrong += error > tolerance;
      squares += error > tolerance ? error * error : 0.0;
      j.max_error = std::max(j.max_error, error > tolerance ? error : 0.0);
    }
  }
  const auto count = static_cast<double>(right.size());
  j.wrong_percent = 100.0 * static_cast<double>(wrong + unfilled) / count;
  j.unfilled_percent = 100.0 * static_cast<double>(unfilled) / count;
  j.rms_error = std::sqrt(squares / std::max(1.0, count - static_cast<double>(unfilled)));
  return j;
}

// Times until the field is an array of floats. They include the first touch of its memory, as ITK's times do.
struct timed {
  std::vector<double> build_ms, array_ms, cpu_ms;
  std::vector<float> distances;
  int passes = 0;
};

double processor_ms()
{
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Repeats by which two runs can be compared: a sign test rejects chance from seven on.
constexpr int repeats_of_fast = 7;

// Returns fewer repeats for large cases, because floodings and ITK take seconds.
int repeats_of_slow(size_t count)
{
  return count > 128 * 128 * 128 ? 1 : repeats_of_fast;
}

timed time_method(stratus_context* context, const stratus_voxels* voxels, const method& m, size_t count)
{
  timed t;
  const int repeats = m.field.method >= STRATUS_FIELD_JFA ? repeats_of_slow(count) : repeats_of_fast;
  for (int i = 0; i < repeats; ++i) {
    stratus_field_report report;
    stratus_field* made = nullptr;
    const double cpu = processor_ms();
    const double start = now_ms();
    check(context, stratus_field_create(context, voxels, &m.field, &made, &report));
    const double built = now_ms();
    const field_pointer field(made);
    std::unique_ptr<float[]> array(new float[count]);
    stratus_field_distances(field.get(), array.get());
    t.array_ms.push_back(now_ms() - start);
    t.cpu_ms.push_back(processor_ms() - cpu);
    t.build_ms.push_back(built - start);
    t.passes = report.passes;
    if (i == 0) {
      t.distances.assign(array.get(), array.get() + count);
    }
  }
  return t;
}

class runner
{
public:
  runner(const options& o) : o_(o), host_(open_context("host", o.threads)) {}

  void run_case(const distance_case& c)
  {
    std::fprintf(stderr, "%s\n", c.name.c_str());
    const voxels_pointer voxels = make_voxels(host_.get(), c.size, c.effective);
    std::vector<float> right[2];
    for (const std::string& name : o_.methods) {
      try {
        run_method(c, name, voxels.get(), right);
      } catch (const failure& e) {
        add_failure(c.name, name, e.what(), rows_);
      }
    }
  }

  const std::vector<row>& rows() const { return rows_; }

private:
  void run_method(const distance_case& c, const std::string& name, const stratus_voxels* voxels, std::vector<float>* right)
  {
    const method m = parse_method(name);
    if (m.is_itk) {
      run_itk_rows(c);
      return;
    }
    const size_t count = c.effective.size();
    stratus_context* context = m.on_device ? device() : host_.get();
    const timed t = time_method(context, voxels, m, count);
    std::vector<float>& exact = right[m.field.is_signed];
    if (exact.empty()) {
      exact = exact_distances(host_.get(), voxels, m.field.is_signed, count);
    }
    const judgement j = judge(t.distances, exact, 0.0);
    add(c.name, name, t, j);
    rows_.push_back({ c.name, name, "passes", "1", static_cast<double>(t.passes) });
  }

  stratus_context* device()
  {
    if (!device_) {
      device_ = open_context("0", o_.threads);
    }
    return device_.get();
  }

  void run_itk_rows(const distance_case& c)
  {
    timed t;
    for (int i = 0; i < repeats_of_slow(c.effective.size()); ++i) {
      const double cpu = processor_ms();
      t.build_ms.push_back(run_itk(c, o_.threads, i == 0 ? &t.distances : nullptr));
      t.cpu_ms.push_back(processor_ms() - cpu);
    }
    t.array_ms = t.build_ms;
    const voxels_pointer contour = make_voxels(host_.get(), c.size, itk_contour(c));
    std::vector<float> right = exact_distances(host_.get(), contour.get(), 0, c.effective.size());
    for (size_t v = 0; v < right.size(); ++v) {
      right[v] = c.effective[v] ? -right[v] : right[v];
    }
    add(c.name, "itk", t, judge(t.distances, right, 1e-3));
  }

  void add(const std::string& scene, const std::string& name, const timed& t, const judgement& j)
  {
    const double build_ms = median(t.build_ms);
    const double array_ms = median(t.array_ms);
    const double cpu_ms = median(t.cpu_ms);
    rows_.push_back({ scene, name, "build_ms", "ms", build_ms });
    add_repeats(scene, name, "array_ms", "ms", t.array_ms, rows_);
    rows_.push_back({ scene, name, "array_ms", "ms", array_ms });
    rows_.push_back({ scene, name, "cpu_ms", "ms", cpu_ms });
    rows_.push_back({ scene, name, "wrong_percent", "%", j.wrong_percent });
    rows_.push_back({ scene, name, "unfilled_percent", "%", j.unfilled_percent });
    rows_.push_back({ scene, name, "max_error", "voxel", j.max_error });
    rows_.push_back({ scene, name, "rms_error", "voxel", j.rms_error });
    std::fprintf(stderr, "  %-22s build %8.2f ms, with floats %8.2f ms, processor %8.2f ms, ", name.c_str(), build_ms, array_ms, cpu_ms);
    std::fprintf(
      stderr, "wrong %8.4f %%, unfilled %8.4f %%, max %7.3f, rms %9.6f\n", j.wrong_percent, j.unfilled_percent, j.max_error, j.rms_error);
  }

  const options& o_;
  context_pointer host_, device_;
  std::vector<row> rows_;
};

// Charts the cases of one size; sets that are empty or full have no wrong voxels in any field.
void chart(const std::string& path, int64_t size, const std::vector<row>& rows)
{
  const std::string ending = "-" + std::to_string(size);
  std::vector<row> shown;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(shown), [&](const row& r) {
    std::string scene = r.scene;
    return cut(scene, ending) && scene != "none" && scene != "all";
  });
  write_chart(path, curves_of("distance", shown).front());
}

// Returns whether all methods were measured.
bool run(const options& o)
{
  check_writable(o.csv);
  runner r(o);
  for (const int64_t size : o.sizes) {
    for (const std::string& name : o.cases) {
      r.run_case(make_distance_case(name, size));
    }
  }
  save_rows(o.csv, r.rows(), "distance", o.append);
  if (!o.chart.empty()) {
    chart(o.chart, *std::max_element(o.sizes.begin(), o.sizes.end()), r.rows());
  }
  return !any_failed(r.rows());
}
} // namespace

int distance_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  if (!o.chart.empty()) {
    ensure_display(argv);
  }
  return run(o) ? 0 : 1;
}
} // namespace bench
