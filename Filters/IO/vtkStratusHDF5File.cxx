// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusHDF5File.h"

#include "vtkStratusHDF5Lock.h"
#include "vtkStratusShuffle.h"

#include "vtkType.h"
#include "vtk_zlib.h"

#include <algorithm>
#include <cstring>
#include <hdf5.h>
#include <numeric>

namespace {

constexpr size_t ChecksumBytes = 4;
constexpr size_t LargestChunk = size_t(1) << 30; // zlib counts in 32 bits

#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info2_t;
constexpr auto Visit = &H5Ovisit3;
#else
using ObjectInfo = H5O_info_t;
constexpr auto Visit = &H5Ovisit2;
#endif

using Call = vtkStratusHDF5Call;

// An object of libhdf5, within a Call.
class Handle
{
public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : Id(id), Close(close) {}
  ~Handle()
  {
    if (this->Id >= 0) {
      this->Close(this->Id);
    }
  }
  Handle(const Handle&) = delete;
  void operator=(const Handle&) = delete;
  operator hid_t() const { return this->Id; }
  bool IsOpen() const { return this->Id >= 0; }
  hid_t Take()
  {
    const hid_t id = this->Id;
    this->Id = -1;
    return id;
  }

private:
  hid_t Id;
  herr_t (*Close)(hid_t);
};

// VTK's type that holds all numbers of a type of the file; VTK_VOID: there is none.
int FindType(hid_t type)
{
  const size_t bytes = H5Tget_size(type);
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_FLOAT) {
    return bytes <= sizeof(float) ? VTK_FLOAT : bytes == sizeof(double) ? VTK_DOUBLE : VTK_VOID;
  }
  if (kind != H5T_INTEGER) {
    return VTK_VOID;
  }
  const bool has_sign = H5Tget_sign(type) == H5T_SGN_2;
  switch (bytes) {
    case 1:
      return has_sign ? VTK_SIGNED_CHAR : VTK_UNSIGNED_CHAR;
    case 2:
      return has_sign ? VTK_SHORT : VTK_UNSIGNED_SHORT;
    case 4:
      return has_sign ? VTK_INT : VTK_UNSIGNED_INT;
    case 8:
      return has_sign ? VTK_TYPE_INT64 : VTK_TYPE_UINT64;
    default:
      return VTK_VOID;
  }
}

// Libhdf5's type of VTK's numbers in memory.
hid_t InMemory(int type)
{
  switch (type) {
    case VTK_SIGNED_CHAR:
      return H5T_NATIVE_INT8;
    case VTK_UNSIGNED_CHAR:
      return H5T_NATIVE_UINT8;
    case VTK_SHORT:
      return H5T_NATIVE_INT16;
    case VTK_UNSIGNED_SHORT:
      return H5T_NATIVE_UINT16;
    case VTK_INT:
      return H5T_NATIVE_INT32;
    case VTK_UNSIGNED_INT:
      return H5T_NATIVE_UINT32;
    case VTK_TYPE_INT64:
      return H5T_NATIVE_INT64;
    case VTK_TYPE_UINT64:
      return H5T_NATIVE_UINT64;
    case VTK_FLOAT:
      return H5T_NATIVE_FLOAT;
    default:
      return H5T_NATIVE_DOUBLE;
  }
}

// Inflates a stream of zlib. Returns the number of bytes, 0 if the stream is damaged or has more than `most` bytes.
size_t Inflate(const char* from, size_t bytes, char* to, size_t most)
{
  z_stream stream = {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from));
  stream.avail_in = static_cast<uInt>(bytes);
  stream.next_out = reinterpret_cast<Bytef*>(to);
  stream.avail_out = static_cast<uInt>(most);
  if (inflateInit(&stream) != Z_OK) {
    return 0;
  }
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  return result == Z_STREAM_END ? most - stream.avail_out : 0;
}

// HDF5's checksum fletcher32, of words of two bytes, the first byte high.
uint32_t Checksum(const unsigned char* bytes, size_t count)
{
  constexpr size_t most = 360; // words before sums of 32 bits may overflow
  uint32_t first = 0, second = 0;
  const auto fold = [](uint32_t sum) { return (sum & 0xffffU) + (sum >> 16); };
  for (size_t i = 0; i + 1 < count;) {
    const size_t end = std::min(i + 2 * most, count - count % 2);
    for (; i < end; i += 2) {
      first += static_cast<uint32_t>(bytes[i]) << 8 | bytes[i + 1];
      second += first;
    }
    first = fold(first);
    second = fold(second);
  }
  if (count % 2 != 0) {
    first += static_cast<uint32_t>(bytes[count - 1]) << 8;
    second += first;
    first = fold(first);
    second = fold(second);
  }
  return fold(second) << 16 | fold(first);
}

// Returns whether the checksum behind `count` bytes is theirs, little endian. HDF5 1.6.2 and older wrote it with the bytes of each half
// swapped on some machines, and libhdf5 accepts both.
bool IsWhole(const char* data, size_t count)
{
  const unsigned char* const bytes = reinterpret_cast<const unsigned char*>(data);
  const unsigned char* const end = bytes + count;
  const uint32_t stored = end[0] | end[1] << 8 | end[2] << 16 | static_cast<uint32_t>(end[3]) << 24;
  const uint32_t sum = Checksum(bytes, count);
  return stored == sum || stored == ((sum & 0x00ff00ffU) << 8 | (sum >> 8 & 0x00ff00ffU));
}

// Calls `work` with the indices of each box of `step` from `first` to before `end` along all dimensions. Stops when it returns false.
template <class Work>
bool ForEach(const std::vector<size_t>& first, const std::vector<size_t>& end, const std::vector<size_t>& step, const Work& work)
{
  std::vector<size_t> at = first;
  for (bool more = true; more;) {
    if (!work(at)) {
      return false;
    }
    more = false;
    for (size_t d = at.size(); d-- > 0 && !more;) {
      at[d] += step[d];
      more = at[d] < end[d];
      at[d] = more ? at[d] : first[d];
    }
  }
  return true;
}

herr_t AddDataSet(hid_t, const char* name, const ObjectInfo* info, void* names)
{
  if (info->type == H5O_TYPE_DATASET) {
    static_cast<std::vector<std::string>*>(names)->push_back(std::string("/") + name);
  }
  return 0;
}
} // namespace

// Where a chunk is worked on: each filter reads one and writes the other, which then change places.
struct vtkStratusHDF5Values::Buffers {
  explicit Buffers(size_t bytes) : Bytes(bytes), Now(new char[bytes]), Next(new char[bytes]) {}

  const size_t Bytes;
  std::unique_ptr<char[]> Now, Next;
};

vtkStratusHDF5Values::vtkStratusHDF5Values(int64_t id, int type) : Id(id), Type(type)
{
  this->FindLayout();
}

vtkStratusHDF5Values::~vtkStratusHDF5Values()
{
  const Call call;
  H5Dclose(this->Id);
}

// Looks up sizes, chunks and filters.
void vtkStratusHDF5Values::FindLayout()
{
  const Handle space(H5Dget_space(this->Id), H5Sclose), type(H5Dget_type(this->Id), H5Tclose),
    plan(H5Dget_create_plist(this->Id), H5Pclose);
  const int rank = std::max(H5Sget_simple_extent_ndims(space), 0);
  std::vector<hsize_t> sizes(static_cast<size_t>(rank)), chunks(sizes.size());
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  this->Sizes.assign(sizes.begin(), sizes.end());
  const H5D_layout_t layout = H5Pget_layout(plan);
  const bool native = H5Tequal(type, InMemory(this->Type)) > 0;
  if (layout == H5D_CONTIGUOUS && native && H5Pget_external_count(plan) == 0) {
    const haddr_t begin = H5Dget_offset(this->Id);
    this->Begin = begin == HADDR_UNDEF ? -1 : static_cast<int64_t>(begin);
  }
  if (layout != H5D_CHUNKED || H5Pget_chunk(plan, rank, chunks.data()) != rank) {
    return;
  }
  this->Chunks.assign(chunks.begin(), chunks.end());
  this->ValueBytes = H5Tget_size(type);
  const double bytes = std::accumulate(chunks.begin(), chunks.end(), static_cast<double>(this->ValueBytes),
    [](double all, hsize_t n) { return all * static_cast<double>(n); });
  unsigned options = 0;
  H5Pget_chunk_opts(plan, &options);
  this->Direct = native && bytes <= static_cast<double>(LargestChunk) && options == 0; // options: filters differ at the border
  this->ChunkBytes = this->Direct ? static_cast<size_t>(bytes) : 0;
  const int count = H5Pget_nfilters(plan);
  int deflated = 0;
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, value = 0;
    size_t values = 1;
    const H5Z_filter_t id = H5Pget_filter2(plan, static_cast<unsigned>(i), &flags, &values, &value, 0, nullptr, nullptr);
    deflated += id == H5Z_FILTER_DEFLATE ? 1 : 0;
    const bool known = id == H5Z_FILTER_DEFLATE || id == H5Z_FILTER_FLETCHER32 || (id == H5Z_FILTER_SHUFFLE && values == 1 && value > 0);
    this->Direct = this->Direct && known && deflated <= 1;
    this->Filters.push_back({ static_cast<int>(id), value });
  }
  this->Direct = this->Direct && count >= 0 && count < 32; // bits of the mask of filters that a chunk skips
}

bool vtkStratusHDF5Values::Read(const size_t* start, const size_t* count, void* values) const
{
  return this->Direct ? this->ReadByChunks(start, count, static_cast<char*>(values)) : this->ReadByLibrary(start, count, count, values);
}

// Reads a box into an array of the sizes `whole`, at its begin.
bool vtkStratusHDF5Values::ReadByLibrary(const size_t* start, const size_t* count, const size_t* whole, void* values) const
{
  const size_t rank = this->Sizes.size();
  const std::vector<hsize_t> first(start, start + rank), size(count, count + rank), all(whole, whole + rank), zero(rank, 0);
  const Call call;
  const Handle from(H5Dget_space(this->Id), H5Sclose), to(H5Screate_simple(static_cast<int>(rank), all.data(), nullptr), H5Sclose);
  return from.IsOpen() && to.IsOpen() && H5Sselect_hyperslab(from, H5S_SELECT_SET, first.data(), nullptr, size.data(), nullptr) >= 0 &&
    H5Sselect_hyperslab(to, H5S_SELECT_SET, zero.data(), nullptr, size.data(), nullptr) >= 0 &&
    H5Dread(this->Id, InMemory(this->Type), to, from, H5P_DEFAULT, values) >= 0;
}

bool vtkStratusHDF5Values::ReadByChunks(const size_t* start, const size_t* count, char* values) const
{
  std::vector<size_t> first(this->Sizes.size()), end(first.size());
  for (size_t d = 0; d < first.size(); ++d) {
    first[d] = start[d] / this->Chunks[d] * this->Chunks[d];
    end[d] = start[d] + count[d];
  }
  // An incompressible chunk may be longer than its values, and checksums follow the values while filters are undone.
  Buffers buffers(2 * this->ChunkBytes + 1024 + ChecksumBytes * this->Filters.size());
  return ForEach(first, end, this->Chunks, [&](const std::vector<size_t>& at) {
    const char* const chunk = this->ReadChunk(at, buffers);
    if (chunk) {
      this->CopyChunk(chunk, at, start, count, values);
    }
    return chunk != nullptr;
  });
}

// Returns the values of the chunk that begins at `first`; null if they cannot be read.
const char* vtkStratusHDF5Values::ReadChunk(const std::vector<size_t>& first, Buffers& buffers) const
{
  const std::vector<hsize_t> at(first.begin(), first.end());
  hsize_t bytes = 0;
  uint32_t skipped = 0;
  {
    const Call call;
    const bool stored = H5Dget_chunk_storage_size(this->Id, at.data(), &bytes) >= 0 && bytes > 0; // an error in 1.10 if it is not
    if (stored && (bytes > buffers.Bytes || H5Dread_chunk(this->Id, H5P_DEFAULT, at.data(), &skipped, buffers.Now.get()) < 0)) {
      return nullptr;
    }
    bytes = stored ? bytes : 0;
  }
  return bytes > 0 ? this->Undo(static_cast<size_t>(bytes), skipped, buffers) : this->FillChunk(first, buffers);
}

// Returns the values of a chunk that was never written, of which libhdf5 knows the fill value; null if it cannot be read otherwise.
const char* vtkStratusHDF5Values::FillChunk(const std::vector<size_t>& first, Buffers& buffers) const
{
  std::vector<size_t> count(first.size());
  for (size_t d = 0; d < first.size(); ++d) {
    count[d] = std::min(this->Chunks[d], this->Sizes[d] - first[d]);
  }
  std::memset(buffers.Now.get(), 0, this->ChunkBytes); // a data set may have no fill value
  return this->ReadByLibrary(first.data(), count.data(), this->Chunks.data(), buffers.Now.get()) ? buffers.Now.get() : nullptr;
}

// Undoes the filters of a chunk of stored bytes. skipped: a bit for each filter that was not applied to it.
const char* vtkStratusHDF5Values::Undo(size_t bytes, uint32_t skipped, Buffers& buffers) const
{
  for (size_t i = this->Filters.size(); i-- > 0;) {
    if (skipped >> i & 1U) {
      continue;
    }
    if (this->Filters[i].Id == H5Z_FILTER_FLETCHER32) {
      if (bytes < ChecksumBytes || !IsWhole(buffers.Now.get(), bytes - ChecksumBytes)) {
        return nullptr;
      }
      bytes -= ChecksumBytes;
      continue;
    }
    if (this->Filters[i].Id == H5Z_FILTER_SHUFFLE) {
      vtkStratusUnshuffle(buffers.Now.get(), bytes, this->Filters[i].ElementBytes, buffers.Next.get());
    } else {
      bytes = Inflate(buffers.Now.get(), bytes, buffers.Next.get(), buffers.Bytes);
    }
    buffers.Now.swap(buffers.Next);
  }
  return bytes == this->ChunkBytes ? buffers.Now.get() : nullptr;
}

// Copies the values of a chunk that are in a box, row by row.
void vtkStratusHDF5Values::CopyChunk(
  const char* chunk, const std::vector<size_t>& first, const size_t* start, const size_t* count, char* values) const
{
  const size_t rank = first.size();
  std::vector<size_t> low(rank), high(rank), step(rank, 1);
  for (size_t d = 0; d < rank; ++d) {
    low[d] = std::max(first[d], start[d]);
    high[d] = std::min(first[d] + this->Chunks[d], start[d] + count[d]);
  }
  const size_t row = high.back() - low.back();
  step.back() = row;
  ForEach(low, high, step, [&](const std::vector<size_t>& at) {
    size_t from = 0, to = 0;
    for (size_t d = 0; d < rank; ++d) {
      from = from * this->Chunks[d] + at[d] - first[d];
      to = to * count[d] + at[d] - start[d];
    }
    std::memcpy(values + to * this->ValueBytes, chunk + from * this->ValueBytes, row * this->ValueBytes);
    return true;
  });
}

void vtkStratusHDF5File::Fail(const std::string& why) const
{
  throw vtkStratusReadError{ this->Path + ": " + why };
}

vtkStratusHDF5File::vtkStratusHDF5File(const std::string& path) : Path(path)
{
  const Call call;
  // Libhdf5 opens a file once for all of the process that have it open by the same driver, and refuses who wants it closed in another way.
  // Libnetcdf, h5py and VTK each want another one, by the usual driver. This one is by another.
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_stdio(access);
  this->Id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (this->Id < 0) {
    this->Fail("no HDF5 file that can be read");
  }
}

vtkStratusHDF5File::~vtkStratusHDF5File()
{
  const Call call;
  H5Fclose(this->Id);
}

bool vtkStratusHDF5File::Has(const std::string& object) const
{
  const Call call;
  return Handle(H5Oopen(this->Id, object.c_str(), H5P_DEFAULT), H5Oclose).IsOpen();
}

std::vector<std::string> vtkStratusHDF5File::List(const std::string& group) const
{
  const Call call;
  std::vector<std::string> names;
  const Handle opened(H5Gopen2(this->Id, group.c_str(), H5P_DEFAULT), H5Gclose);
  H5G_info_t info;
  if (!opened.IsOpen() || H5Gget_info(opened, &info) < 0) {
    return names;
  }
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t length = H5Lget_name_by_idx(opened, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    std::vector<char> name(static_cast<size_t>(std::max<ssize_t>(length, 0)) + 1, 0);
    if (H5Lget_name_by_idx(opened, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT) > 0) {
      names.push_back(name.data());
    }
  }
  return names;
}

std::vector<std::string> vtkStratusHDF5File::ListDataSets() const
{
  const Call call;
  std::vector<std::string> names;
  Visit(this->Id, H5_INDEX_NAME, H5_ITER_INC, &AddDataSet, &names, H5O_INFO_BASIC);
  return names;
}

std::string vtkStratusHDF5File::Text(const std::string& object, const char* attribute) const
{
  const Call call;
  const Handle of(H5Oopen(this->Id, object.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle opened(of.IsOpen() && H5Aexists(of, attribute) > 0 ? H5Aopen(of, attribute, H5P_DEFAULT) : -1, H5Aclose);
  if (!opened.IsOpen()) {
    return "";
  }
  const Handle type(H5Aget_type(opened), H5Tclose), space(H5Aget_space(opened), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) {
    return "";
  }
  const Handle same(H5Tcopy(type), H5Tclose); // of this set of letters
  std::string text;
  if (H5Tis_variable_str(type) > 0) {
    char* read = nullptr;
    if (H5Aread(opened, same, &read) >= 0 && read) {
      text = read;
      H5free_memory(read);
    }
  } else {
    std::vector<char> read(H5Tget_size(type) + 1, 0);
    if (H5Aread(opened, same, read.data()) >= 0) {
      text = read.data();
    }
  }
  return text.substr(0, text.find_last_not_of(' ') + 1); // padded by some
}

std::vector<double> vtkStratusHDF5File::Numbers(const std::string& object, const char* attribute, size_t most) const
{
  const Call call;
  const Handle of(H5Oopen(this->Id, object.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle opened(of.IsOpen() && H5Aexists(of, attribute) > 0 ? H5Aopen(of, attribute, H5P_DEFAULT) : -1, H5Aclose);
  if (!opened.IsOpen()) {
    return {};
  }
  const Handle type(H5Aget_type(opened), H5Tclose), space(H5Aget_space(opened), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  std::vector<double> numbers;
  if (FindType(type) != VTK_VOID && count > 0 && static_cast<size_t>(count) <= most) {
    numbers.resize(static_cast<size_t>(count));
    numbers.resize(H5Aread(opened, H5T_NATIVE_DOUBLE, numbers.data()) >= 0 ? numbers.size() : 0);
  }
  return numbers;
}

std::unique_ptr<vtkStratusHDF5Values> vtkStratusHDF5File::Open(const std::string& name) const
{
  const Call call;
  Handle object(H5Oopen(this->Id, name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.IsOpen() || H5Iget_type(object) != H5I_DATASET) {
    return nullptr;
  }
  const Handle type(H5Dget_type(object), H5Tclose);
  const int found = type.IsOpen() ? FindType(type) : VTK_VOID;
  return found == VTK_VOID ? nullptr : std::make_unique<vtkStratusHDF5Values>(object.Take(), found);
}
