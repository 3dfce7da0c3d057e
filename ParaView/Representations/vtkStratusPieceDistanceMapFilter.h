// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPieceDistanceMapFilter
 * @brief   vtkStratusDistanceMapFilter for an image that is distributed over ParaView's ranks
 *
 * The ranks combine their lists of occupied blocks, so that distances are equal to the distances in the whole image. In particular, no
 * block counts as empty that another rank's piece occupies. Blocks begin at the first point of the whole image. Each rank outputs the
 * blocks that begin in a cell that it owns (not a ghost). The extent of its output counts blocks of the whole image. "StratusGlobalBlock"
 * numbers the blocks over all ranks, x fastest. A rank without blocks outputs none. Each rank keeps one byte for each block of the whole
 * image, and eight bytes while distances are computed.
 *
 * Pieces must be images that share their border points. Cell values need a layer of ghost cells, which the filter requests.
 */
#ifndef vtkStratusPieceDistanceMapFilter_h
#define vtkStratusPieceDistanceMapFilter_h

#include "StratusParaViewRepresentationsModule.h" // For export macro
#include "vtkStratusDistanceMapFilter.h"

#include <vector> // For std::vector

class vtkImageData;

class STRATUSPARAVIEWREPRESENTATIONS_EXPORT vtkStratusPieceDistanceMapFilter : public vtkStratusDistanceMapFilter
{
public:
  static vtkStratusPieceDistanceMapFilter* New();
  vtkTypeMacro(vtkStratusPieceDistanceMapFilter, vtkStratusDistanceMapFilter);

protected:
  vtkStratusPieceDistanceMapFilter();
  ~vtkStratusPieceDistanceMapFilter() override;

  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkStratusPieceDistanceMapFilter(const vtkStratusPieceDistanceMapFilter&) = delete;
  void operator=(const vtkStratusPieceDistanceMapFilter&) = delete;

  // The blocks of the whole: from which value of it on, and how many, along each axis.
  struct Lattice {
    int First[3], Blocks[3];
    vtkIdType GetCount() const { return static_cast<vtkIdType>(this->Blocks[0]) * this->Blocks[1] * this->Blocks[2]; }
    vtkIdType GetNumber(int i, int j, int k) const { return i + this->Blocks[0] * (j + static_cast<vtkIdType>(this->Blocks[1]) * k); }
  };

  void SetSettings(vtkStratusDistanceMapFilter* filter, int kind, int block);
  bool FindOccupied(vtkImageData* piece, bool cells, const Lattice& lattice, std::vector<unsigned char>& occupied);
  bool FindDistances(const Lattice& lattice, const std::vector<unsigned char>& occupied, std::vector<unsigned char>& distances);
  void Fill(vtkImageData* piece, bool cells, const Lattice& lattice, const std::vector<unsigned char>& occupied,
    const std::vector<unsigned char>& distances, vtkImageData* output);
};

#endif
