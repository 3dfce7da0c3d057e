// SPDX-License-Identifier: BSD-3-Clause
// Whether a prop's bounds may have changed, without asking for them: asking updates the pipeline behind a mapper and walks its cells, which
// is what culling costs. Private to the module, never installed.
#ifndef vtkStratusBoundsWatch_h
#define vtkStratusBoundsWatch_h

#include "vtkAlgorithm.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <typeindex>
#include <unordered_map>
#include <vector>

class vtkProp;

#if defined(__GNUC__)
#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))
#else
#define VTK_STRATUS_PRIVATE
#endif

class VTK_STRATUS_PRIVATE vtkStratusBoundsWatch
{
public:
  vtkStratusBoundsWatch();

  // An algorithm, and the newest modification of all that it is fed by. Several mappers may share what is behind them: it is read once a
  // look.
  struct Producer {
    vtkWeakPointer<vtkAlgorithm> Algorithm;
    bool Mapper = false; // its data count, too: they may be edited in place
    vtkMTimeType Own = 0, Newest = 0;
    uint64_t Look = 0;
    std::vector<Producer*> Inputs;
  };

  // Of one prop. Times are compared for being equal, not for being later: whatever is newest may go.
  struct State {
    bool Known = false; // else its bounds are asked at each look
    vtkMTimeType Own = 0, Newest = 0;
    Producer* Mapper = nullptr;
  };

  // What has been read is read again.
  void NextLook();
  // Whether the bounds may be others than when this was last called.
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
