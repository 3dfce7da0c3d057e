// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPiecePartitionFilter
 * @brief   vtkStratusPartitionFilter for a mesh that is distributed over ParaView's ranks
 *
 * Each rank cuts its piece into leaves of its own, which are numbered from 0, as renderers expect. In addition, the cells get numbers over
 * all ranks: "StratusGlobalLeaf", leaves of rank 0 first, and "StratusGlobalOriginalCell", the global id of the input cell that each comes
 * from. If the input has no global ids, this is the cell's number among the cells of all pieces, rank 0 first. A rank without cells outputs
 * none.
 */
#ifndef vtkStratusPiecePartitionFilter_h
#define vtkStratusPiecePartitionFilter_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkStratusPartitionFilter.h"

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusPiecePartitionFilter : public vtkStratusPartitionFilter
{
public:
  static vtkStratusPiecePartitionFilter* New();
  vtkTypeMacro(vtkStratusPiecePartitionFilter, vtkStratusPartitionFilter);

protected:
  vtkStratusPiecePartitionFilter();
  ~vtkStratusPiecePartitionFilter() override;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkStratusPiecePartitionFilter(const vtkStratusPiecePartitionFilter&) = delete;
  void operator=(const vtkStratusPiecePartitionFilter&) = delete;
};

#endif
