// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusBoundsWatch.h"

#include "vtkActor.h"
#include "vtkDataObject.h"
#include "vtkDataSetMapper.h"
#include "vtkMapper.h"
#include "vtkNew.h"
#include "vtkPolyDataMapper.h"
#include "vtkTimeStamp.h"

#include <algorithm>
#include <typeinfo>

namespace {
template <class T> std::type_index TypeOf(const T& object)
{
  return std::type_index(typeid(object));
}

// Every modification in the process takes the next number, and so does this.
vtkMTimeType Now()
{
  vtkTimeStamp stamp;
  stamp.Modified();
  return stamp.GetMTime();
}

bool Among(const std::vector<std::type_index>& types, std::type_index type)
{
  return std::find(types.begin(), types.end(), type) != types.end();
}
} // namespace

// Classes are recognised by their exact type, because a derived class may compute its bounds from anything. New() returns the class that an
// object factory may put in their place.
vtkStratusBoundsWatch::vtkStratusBoundsWatch()
{
  vtkNew<vtkActor> actor;
  vtkNew<vtkPolyDataMapper> polyDataMapper;
  vtkNew<vtkDataSetMapper> dataSetMapper;
  this->Actors = { TypeOf(*actor.Get()) };
  this->Mappers = { TypeOf(*polyDataMapper.Get()), TypeOf(*dataSetMapper.Get()) };
}

void vtkStratusBoundsWatch::NextLook()
{
  ++this->Look;
  this->Start = Now();
  if (this->Producers.size() > this->SweepAt) {
    this->Sweep();
  }
}

void vtkStratusBoundsWatch::Asked(State& state) const
{
  state.Before = this->Start;
  state.After = Now();
  state.Newest = 0;
}

bool vtkStratusBoundsWatch::Changed(vtkProp* prop, State& state)
{
  if (!state.Mapper && !Among(this->Actors, TypeOf(*prop))) {
    return true;
  }
  vtkActor* actor = static_cast<vtkActor*>(prop);
  // vtkProp3D's time, not vtkActor's: colours and textures change no bounds, and each costs one more memory access.
  if (actor->vtkProp3D::GetMTime() > state.Before) {
    state.Mapper = nullptr; // maybe it has another mapper now
    return true;
  }
  state.Mapper = state.Mapper ? state.Mapper : this->Resolve(actor);
  if (!state.Mapper) {
    return true;
  }
  this->Read(*state.Mapper);
  // Between looks that query nothing, times are compared for equality, because the object with the newest time may be removed.
  const vtkMTimeType newest = std::max(state.Mapper->Newest, state.Mapper->Data);
  const bool same = state.Newest == 0 || state.Newest == newest;
  state.Newest = newest;
  return !same || state.Mapper->Newest > state.Before || state.Mapper->Data > state.After;
}

// Returns NULL if it is not known from where the bounds come.
vtkStratusBoundsWatch::Producer* vtkStratusBoundsWatch::Resolve(vtkActor* actor)
{
  vtkMapper* mapper = actor->GetMapper();
  return mapper && Among(this->Mappers, TypeOf(*mapper)) ? this->Find(mapper, true) : nullptr;
}

// Forgets algorithms that are gone. Pointers to them may remain in actors and algorithms that were connected to them. Those have been
// modified since, so that their pointers are replaced before they are followed.
void vtkStratusBoundsWatch::Sweep()
{
  for (auto entry = this->Producers.begin(); entry != this->Producers.end();) {
    entry = entry->second.Algorithm ? std::next(entry) : this->Producers.erase(entry);
  }
  this->SweepAt = std::max<size_t>(1024, 2 * this->Producers.size());
}

vtkStratusBoundsWatch::Producer* vtkStratusBoundsWatch::Find(vtkAlgorithm* algorithm, bool mapper)
{
  Producer& producer = this->Producers[algorithm];
  if (producer.Algorithm != algorithm) { // new, or at the address of an algorithm that is gone
    producer = Producer();
    producer.Algorithm = algorithm;
    producer.Mapper = mapper;
    this->Collect(producer);
  }
  return &producer;
}

void vtkStratusBoundsWatch::Collect(Producer& producer)
{
  vtkAlgorithm* algorithm = producer.Algorithm;
  std::vector<Producer*> inputs;
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port) {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i) {
      if (vtkAlgorithm* input = algorithm->GetInputAlgorithm(port, i)) {
        inputs.push_back(this->Find(input, false));
      }
    }
  }
  producer.Inputs = std::move(inputs);
  producer.Own = producer.Mapper ? algorithm->vtkObject::GetMTime() : algorithm->GetMTime();
}

void vtkStratusBoundsWatch::Read(Producer& producer)
{
  if (producer.Look == this->Look) {
    return;
  }
  producer.Look = this->Look;
  vtkAlgorithm* algorithm = producer.Algorithm;
  // Only the mapper's own time counts: lookup tables and clipping planes change no bounds.
  const vtkMTimeType own = producer.Mapper ? algorithm->vtkObject::GetMTime() : algorithm->GetMTime();
  if (own != producer.Own) {
    this->Collect(producer);
  }
  producer.Newest = own;
  for (Producer* input : producer.Inputs) {
    this->Read(*input);
    producer.Newest = std::max(producer.Newest, input->Newest);
  }
  if (producer.Mapper) {
    vtkDataObject* data = algorithm->GetNumberOfInputConnections(0) > 0 ? algorithm->GetInputDataObject(0, 0) : nullptr;
    producer.Data = data ? data->GetMTime() : 0;
  }
}
