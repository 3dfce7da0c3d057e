// SPDX-License-Identifier: BSD-3-Clause
// An array of Zarr: its metadata, and blocks of its values. Private to the module.
#ifndef vtkStratusZarrArray_h
#define vtkStratusZarrArray_h

#include "vtkStratusReadError.h"
#include "vtkStratusZarrCodecs.h"

#include "vtk_jsoncpp.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

class vtkStratusZarrArray
{
public:
  // Reads the metadata of version 2 (the contents of .zarray and .zattrs) or 3 (of zarr.json). folder: of the array's files, with a slash
  // behind. Metadata that are wrong or not supported become GetFault(); without shape and chunks the array has no dimensions.
  vtkStratusZarrArray(const std::string& folder, const Json::Value& metadata, const Json::Value& attributes);

  // Why values can't be read, "" if they can.
  const std::string& GetFault() const { return this->Fault; }
  void SetFault(const std::string& why) { this->Fault = this->Fault.empty() ? why : this->Fault; }
  const std::vector<size_t>& GetShape() const { return this->Shape; }
  const std::vector<size_t>& GetChunk() const { return this->Chunk; }      // what is decoded at once; as many dimensions as the shape
  const std::vector<std::string>& GetNames() const { return this->Names; } // of dimensions; "" for one without a name
  int GetType() const { return this->Type; }                               // vtkStratusNetCDFType; halves are floats
  size_t GetValueBytes() const { return this->ValueBytes; }                // of this type
  const Json::Value& GetAttributes() const { return this->Attributes; }
  // The fill value where it says that a value is missing, as in arrays of version 2 by xarray and libnetcdf; otherwise null.
  const Json::Value& GetMissing() const { return this->Missing; }

  // Reads the values from `start` on, `count` along each dimension, to `to`. strides: bytes between neighbours along each dimension there.
  // parallel: in several threads. Several threads may call it. Throws vtkStratusReadError.
  void Read(
    const std::vector<size_t>& start, const std::vector<size_t>& count, char* to, const std::vector<int64_t>& strides, bool parallel) const;

  // Returns a number that follows from lengths, times and places of all of the array's files; 0 where they are too many to look at.
  uint64_t GetIdentity() const;

private:
  struct Scratch;
  class ShardIndex;

  void ReadVersion2(const Json::Value& metadata);
  void ReadVersion3(const Json::Value& metadata);
  void ReadType2(const Json::Value& type);
  void ReadType3(const Json::Value& type);
  void SetType(char kind, size_t bytes);
  void ReadFill(const Json::Value& value);
  void ReadKeys3(const Json::Value& encoding);
  void ReadCodecs3(const Json::Value& codecs, bool inner);
  void ReadSharding(const Json::Value& configuration);
  void ReadNames(const Json::Value& names);
  void AddCodec(const std::string& name, const Json::Value& configuration);
  void CheckSizes();
  std::string KeyOf(const size_t* shard) const;
  std::string PathOf(const size_t* chunk, size_t& number, size_t& count) const;
  bool LoadFile(const std::string& path, size_t most, vtkStratusZarrBytes& bytes) const;
  bool LoadPart(const size_t* chunk, vtkStratusZarrBytes& bytes) const;
  bool LoadChunk(const size_t* chunk, Scratch& scratch) const;
  void ReadChunk(const std::vector<size_t>& chunk, const std::vector<size_t>& start, const std::vector<size_t>& count, char* to,
    const std::vector<int64_t>& strides, Scratch& scratch) const;

  std::string Folder, Fault;
  std::vector<std::string> MetadataFiles;
  std::vector<size_t> Shape, Chunk, Shard; // Shard: of a file; Chunk, unless files have several chunks
  std::vector<size_t> Order;               // dimensions of a chunk's values, slowest first
  std::vector<std::string> Names;
  int Type = 0;
  size_t StoredBytes = 0, ValueBytes = 0; // of a value in the file, and of Type
  bool Swapped = false, Half = false;
  std::vector<char> Fill; // a value of Type
  std::string Prefix;     // of chunks' keys
  char Separator = '.';
  std::vector<vtkStratusZarrCodec> Codecs; // in the order in which they are undone
  size_t ChunkBytes = 0;                   // stored, without codecs
  bool IsSharded = false, IndexFirst = false, IndexSum = false;
  std::shared_ptr<ShardIndex> Index;
  Json::Value Attributes, Missing;
};

// Reads a file of JSON. Returns false if there is none. Throws vtkStratusReadError for one that cannot be read.
bool vtkStratusReadJson(const std::string& path, Json::Value& value);

#endif
