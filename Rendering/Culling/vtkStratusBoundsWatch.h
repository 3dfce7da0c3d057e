// SPDX-License-Identifier: BSD-3-Clause
// Tells whether a prop's bounds may have changed without asking for them. Asking updates the pipeline behind a mapper and walks its cells,
// which is what culling costs. Private to the module, never installed.
#ifndef vtkStratusBoundsWatch_h
#define vtkStratusBoundsWatch_h

#include "vtkStratusPrivate.h"

#include "vtkAlgorithm.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <typeindex>
#include <unordered_map>
#include <vector>

class vtkProp;

class VTK_STRATUS_PRIVATE vtkStratusBoundsWatch
{
public:
  vtkStratusBoundsWatch();

  // An algorithm and the newest modification time of it and its inputs. Several mappers may share their inputs, so that times are read once
  // per look.
  struct Producer {
    vtkWeakPointer<vtkAlgorithm> Algorithm;
    bool Mapper = false; // the times of its input data count, too, because data may be edited in place
    vtkMTimeType Own = 0, Newest = 0;
    uint64_t Look = 0;
    std::vector<Producer*> Inputs;
  };

  // State of one prop. Times are compared for equality, not for order, because the object with the newest time may go.
  struct State {
    bool Known = false; // false: the bounds are asked for at each look
    vtkMTimeType Own = 0, Newest = 0;
    Producer* Mapper = nullptr;
  };

  // Starts a look, one pass over the props that reads all times anew.
  void NextLook();
  // Returns whether the bounds may have changed since the last call with this state.
  bool Changed(vtkProp* prop, State& state);

private:
  void Resolve(vtkProp* prop, State& state);
  Producer* Find(vtkAlgorithm* algorithm, bool mapper);
  vtkMTimeType Newest(Producer& producer);
  void Collect(Producer& producer);
  void Sweep();

  uint64_t Look = 1;
  size_t SweepAt = 1024;
  std::unordered_map<vtkAlgorithm*, Producer> Producers;
  std::vector<std::type_index> Actors, Mappers;
};

#endif
