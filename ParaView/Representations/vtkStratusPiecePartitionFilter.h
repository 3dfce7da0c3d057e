// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPiecePartitionFilter
 * @brief   vtkStratusPartitionFilter of a mesh of which each rank of ParaView has a piece
 *
 * Each rank cuts its piece into leaves of its own, which are numbered from 0 on, as renderers read them. Beside these numbers the cells get
 * those among all ranks: "StratusGlobalLeaf", leaves of rank 0 first, and "StratusGlobalOriginalCell", the input's global id of the cell
 * that each comes from, or, where it has none, the cell's number among the pieces' cells, those of rank 0 first. Ranks without cells give
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
