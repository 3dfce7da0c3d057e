// SPDX-License-Identifier: BSD-3-Clause
// ITK's distance transform, for comparison. It measures from the contour: the distance is 0 on effective voxels that touch others, and
// negative farther inside.
#include "bench.h"
#include "distance.h"

#include <itkImage.h>
#include <itkImportImageFilter.h>
#include <itkMultiThreaderBase.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>

namespace bench {

using byte_image = itk::Image<unsigned char, 3>;
using float_image = itk::Image<float, 3>;

double run_itk(const distance_case& c, int threads, std::vector<float>* distances)
{
  using importer = itk::ImportImageFilter<unsigned char, 3>;
  using maurer = itk::SignedMaurerDistanceMapImageFilter<byte_image, float_image>;
  const auto edge = static_cast<itk::SizeValueType>(c.size);
  const double unit[3] = { 1.0, 1.0, 1.0 };
  const double zero[3] = { 0.0, 0.0, 0.0 };
  importer::RegionType region;
  region.SetSize(importer::SizeType{ { edge, edge, edge } });
  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
  const auto input = importer::New();
  input->SetRegion(region);
  input->SetOrigin(zero);
  input->SetSpacing(unit);
  input->SetImportPointer(const_cast<unsigned char*>(c.effective.data()), c.effective.size(), false);
  input->Update();
  const auto filter = maurer::New();
  filter->SetInput(input->GetOutput());
  filter->SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(threads));
  filter->SetSquaredDistance(false);
  filter->SetUseImageSpacing(true);
  filter->SetInsideIsPositive(false);
  filter->SetBackgroundValue(0);
  const double start = now_ms();
  filter->Update();
  const double ms = now_ms() - start;
  if (distances) {
    const float* values = filter->GetOutput()->GetBufferPointer();
    distances->assign(values, values + c.effective.size());
  }
  return ms;
}

std::vector<uint8_t> itk_contour(const distance_case& c)
{
  std::vector<uint8_t> contour(c.effective.size(), 0);
  const int64_t n = c.size;
  for (int64_t v = 0; v < n * n * n; ++v) {
    const int64_t x = v % n;
    const int64_t y = v / n % n;
    const int64_t z = v / (n * n);
    bool touches = false;
    for (int64_t k = std::max<int64_t>(z - 1, 0); c.effective[static_cast<size_t>(v)] && k <= std::min(z + 1, n - 1); ++k) {
      for (int64_t j = std::max<int64_t>(y - 1, 0); j <= std::min(y + 1, n - 1); ++j) {
        for (int64_t i = std::max<int64_t>(x - 1, 0); i <= std::min(x + 1, n - 1); ++i) {
          touches = touches || !c.effective[static_cast<size_t>((k * n + j) * n + i)];
        }
      }
    }
    contour[static_cast<size_t>(v)] = touches;
  }
  return contour;
}
} // namespace bench
