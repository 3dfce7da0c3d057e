// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPieceHybridTreeFilter
 * @brief   vtkStratusHybridTreeFilter of an image of which each rank of ParaView has a piece
 *
 * Each rank builds the tree of its own piece, by which it draws. The cells of the second output, a box for each node, get numbers among
 * all ranks: "StratusGlobalNode", nodes of rank 0 first, and "StratusGlobalLeaf", the same of leaves, -1 for inner nodes. Ranks without
 * cells give none.
 */
#ifndef vtkStratusPieceHybridTreeFilter_h
#define vtkStratusPieceHybridTreeFilter_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkStratusHybridTreeFilter.h"

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusPieceHybridTreeFilter : public vtkStratusHybridTreeFilter
{
public:
  static vtkStratusPieceHybridTreeFilter* New();
  vtkTypeMacro(vtkStratusPieceHybridTreeFilter, vtkStratusHybridTreeFilter);

protected:
  vtkStratusPieceHybridTreeFilter();
  ~vtkStratusPieceHybridTreeFilter() override;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkStratusPieceHybridTreeFilter(const vtkStratusPieceHybridTreeFilter&) = delete;
  void operator=(const vtkStratusPieceHybridTreeFilter&) = delete;
};

#endif
