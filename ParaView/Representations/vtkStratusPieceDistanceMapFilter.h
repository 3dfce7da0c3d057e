// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPieceDistanceMapFilter
 * @brief   vtkStratusDistanceMapFilter of an image of which each rank of ParaView has a piece
 *
 * The ranks put together which blocks are occupied, so that distances are those of the whole image, as one rank has them: none tells of
 * emptiness that another rank's piece has not. Blocks begin at the first point of the whole. Each rank gives those that begin in a cell of
 * its own, which is no ghost; the extent of its output counts blocks of the whole. "StratusGlobalBlock" numbers them over all ranks, x
 * fastest. Ranks without blocks give none. Each keeps a byte for each block of the whole, and eight while distances are taken.
 *
 * Pieces must be images that share their border points; values of cells need a layer of ghost cells, which is asked for.
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
