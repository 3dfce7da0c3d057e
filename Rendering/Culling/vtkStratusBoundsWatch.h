// SPDX-License-Identifier: BSD-3-Clause
// Decides whether a prop's bounds may have changed without querying them. A query updates the pipeline behind a mapper and walks its cells,
// which is the cost of culling. Private to the module, never installed.
#ifndef vtkStratusBoundsWatch_h
#define vtkStratusBoundsWatch_h

#include "vtkStratusPrivate.h"

#include "vtkAlgorithm.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <typeindex>
#include <unordered_map>
#include <vector>

class vtkActor;
class vtkProp;

class VTK_STRATUS_PRIVATE vtkStratusBoundsWatch
{
public:
  vtkStratusBoundsWatch();

  // An algorithm and the newest modification time of it and its inputs. Several mappers may share their inputs, so that times are read once
  // per look.
  struct Producer {
    vtkWeakPointer<vtkAlgorithm> Algorithm;
    bool Mapper = false; // its input data may be edited in place, so that their time counts, too
    vtkMTimeType Own = 0, Newest = 0;
    vtkMTimeType Data = 0; // of a mapper's input data
    uint64_t Look = 0;
    std::vector<Producer*> Inputs;
  };

  // State of one prop: when its bounds were queried, and their source. A source has not changed since then if it is no newer than Before. A
  // query may execute the pipeline, so that data may be as new as After.
  struct State {
    vtkMTimeType Before = 0, After = 0;
    vtkMTimeType Newest = 0;    // of all sources at the last look; 0 after a query of bounds
    Producer* Mapper = nullptr; // NULL until a look needs it after the prop was modified
  };

  // Starts a look, one pass over the props that reads all times anew.
  void NextLook();
  // Notes that the prop's bounds have been queried. It looks at nothing, so that a look visits a prop or its sources, not both.
  void Asked(State& state) const;
  bool IsAsked(const State& state) const { return state.Before == this->Start; } // in this look
  // Returns whether the bounds may have changed since they were queried: also true if the sources are not known.
  bool Changed(vtkProp* prop, State& state);

private:
  Producer* Resolve(vtkActor* actor);
  Producer* Find(vtkAlgorithm* algorithm, bool mapper);
  void Read(Producer& producer);
  void Collect(Producer& producer);
  void Sweep();

  uint64_t Look = 1;
  vtkMTimeType Start = 0; // of the look
  size_t SweepAt = 1024;
  std::unordered_map<vtkAlgorithm*, Producer> Producers;
  std::vector<std::type_index> Actors, Mappers;
};

#endif
