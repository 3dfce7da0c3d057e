// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusBoundsWatch.h"

#include "vtkActor.h"
#include "vtkDataObject.h"
#include "vtkDataSetMapper.h"
#include "vtkMapper.h"
#include "vtkNew.h"
#include "vtkPolyDataMapper.h"

#include <algorithm>
#include <typeinfo>

namespace {
template <class T> std::type_index TypeOf(const T& object)
{
  return std::type_index(typeid(object));
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
  if (this->Producers.size() > this->SweepAt) {
    this->Sweep();
  }
}

bool vtkStratusBoundsWatch::Changed(vtkProp* prop, State& state)
{
  if (state.Known) {
    // vtkProp3D's time, not vtkActor's: colours and textures change no bounds, and each costs one more memory access.
    const vtkMTimeType own = static_cast<vtkActor*>(prop)->vtkProp3D::GetMTime();
    if (own == state.Own) {
      const vtkMTimeType newest = this->Newest(*state.Mapper);
      const bool changed = newest != state.Newest;
      state.Newest = newest;
      return changed;
    }
  }
  this->Resolve(prop, state);
  return true;
}

void vtkStratusBoundsWatch::Resolve(vtkProp* prop, State& state)
{
  state = State();
  if (!Among(this->Actors, TypeOf(*prop))) {
    return;
  }
  vtkActor* actor = static_cast<vtkActor*>(prop);
  vtkMapper* mapper = actor->GetMapper();
  if (!mapper || !Among(this->Mappers, TypeOf(*mapper))) {
    return;
  }
  state.Known = true;
  state.Own = actor->vtkProp3D::GetMTime();
  state.Mapper = this->Find(mapper, true);
  state.Newest = this->Newest(*state.Mapper);
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

vtkMTimeType vtkStratusBoundsWatch::Newest(Producer& producer)
{
  if (producer.Look == this->Look) {
    return producer.Newest;
  }
  producer.Look = this->Look;
  vtkAlgorithm* algorithm = producer.Algorithm;
  // Only the mapper's own time counts: lookup tables and clipping planes change no bounds.
  const vtkMTimeType own = producer.Mapper ? algorithm->vtkObject::GetMTime() : algorithm->GetMTime();
  if (own != producer.Own) {
    this->Collect(producer);
  }
  vtkMTimeType newest = own;
  for (Producer* input : producer.Inputs) {
    newest = std::max(newest, this->Newest(*input));
  }
  if (producer.Mapper && algorithm->GetNumberOfInputConnections(0) > 0) {
    if (vtkDataObject* data = algorithm->GetInputDataObject(0, 0)) {
      newest = std::max(newest, data->GetMTime());
    }
  }
  return producer.Newest = newest;
}
