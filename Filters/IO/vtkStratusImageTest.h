// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusImageTest
 * @brief   compares an image with a baseline: to the bit, within an error, or by structural similarity
 *
 * An image is a vtkImageData of one layer, as a mapper's GetLastImage() returns it, or a file: .exr, .png and others that VTK reads as an
 * image. No window and no display are needed.
 *
 * @code
 * vtkNew<vtkStratusImageTest> test;
 * test->SetImage(mapper->GetLastImage());
 * test->SetBaselineFileName("cloud.exr");
 * test->SetTolerance(1e-3);
 * return test->Compare() ? EXIT_SUCCESS : EXIT_FAILURE;
 * @endcode
 *
 * Colours are the point data's array "RGBA" or "RGB", otherwise its scalars: 1 to 4 components, grey, grey and alpha, RGB or RGBA. Bytes
 * and integers of 16 bits are scaled to 0..1; floats are not scaled. Each limit that is set is checked:
 *
 * | limit | the pictures are alike if |
 * |---|---|
 * | Exact, or no limit at all | all arrays have the same names, types and bits |
 * | Tolerance | the root mean square difference of the colours, over pixels that are not 0 in both pictures, is at most this |
 * | MaximumDifference | no component of any colour differs by more |
 * | LeastSSIM | the structural similarity is at least this |
 *
 * Tolerance has the unit of the mappers' ImageErrorTolerance: .001 is 60 dB. If only one image has an alpha, alpha is compared only with
 * Exact. A NaN or an infinity differs from everything but the same bits, by an infinite amount.
 *
 * Structural similarity is the mean over all components and all windows of 11 x 11 pixels that are within the picture, with Gaussian
 * weights of standard deviation 1.5, K1 = .01 and K2 = .03 (Wang et al., Image quality assessment: from error visibility to structural
 * similarity, IEEE Transactions on Image Processing 13(4), 2004). It is 1 for equal pictures and computed where LeastSSIM is set.
 *
 * @sa vtkStratusEXRReader vtkStratusEXRWriter vtkStratusVolumeMapper
 */
#ifndef vtkStratusImageTest_h
#define vtkStratusImageTest_h

#include "StratusFiltersIOModule.h" // For export macro
#include "vtkObject.h"

#include <memory> // For std::unique_ptr
#include <string> // For std::string

class vtkImageData;

class STRATUSFILTERSIO_EXPORT vtkStratusImageTest : public vtkObject
{
public:
  static vtkStratusImageTest* New();
  vtkTypeMacro(vtkStratusImageTest, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the picture that is judged. FileName counts where Image is nullptr. Default none.
   */
  void SetImage(vtkImageData* image);
  vtkImageData* GetImage();
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  //@{
  /**
   * Set/Get what it is held to. BaselineFileName counts where Baseline is nullptr. Default none.
   */
  void SetBaseline(vtkImageData* image);
  vtkImageData* GetBaseline();
  vtkSetFilePathMacro(BaselineFileName);
  vtkGetFilePathMacro(BaselineFileName);
  //@}

  //@{
  /**
   * Set/Get whether the pictures must be the same to the bit. Default off; it holds, too, where no other limit is set.
   */
  vtkSetMacro(Exact, bool);
  vtkGetMacro(Exact, bool);
  vtkBooleanMacro(Exact, bool);
  //@}

  //@{
  /**
   * Set/Get the largest root mean square difference of colours in 0..1. Default -1: not judged. Range: -1, or 0 and above.
   */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  //@}

  //@{
  /**
   * Set/Get the largest difference of a component of a colour. Default -1: not judged. Range: -1, or 0 and above.
   */
  vtkSetMacro(MaximumDifference, double);
  vtkGetMacro(MaximumDifference, double);
  //@}

  //@{
  /**
   * Set/Get the least structural similarity. Default -2: not judged. Range: -2, or -1..1.
   */
  vtkSetMacro(LeastSSIM, double);
  vtkGetMacro(LeastSSIM, double);
  //@}

  /**
   * Compare the images. Return whether they are within the limits. GetReason() says why not. An image that cannot be read or compared is an
   * error, too.
   */
  bool Compare();

  //@{
  /**
   * Get the results of the last Compare(): whether it failed instead of comparing; a sentence, empty if the images are within the limits;
   * the images' size; pixels of which any bit differs; pixels that are not 0 in both; the largest difference of a component, and its pixel,
   * from the bottom left; the root mean square difference over pixels that are not 0; and the structural similarity, -2 if it was not
   * requested.
   */
  vtkGetMacro(Failed, bool);
  std::string GetReason();
  vtkGetVector2Macro(Size, int);
  vtkGetMacro(NumberOfDifferentPixels, vtkIdType);
  vtkGetMacro(NumberOfLitPixels, vtkIdType);
  vtkGetMacro(LargestDifference, double);
  vtkGetVector2Macro(LargestDifferencePixel, int);
  vtkGetMacro(RootMeanSquare, double);
  vtkGetMacro(SSIM, double);
  //@}

  /**
   * Write what differed in the last Compare(): .png gets the absolute differences of R, G and B, stretched so that the largest is white;
   * .exr gets the differences as they are, image less baseline. Return whether it was written.
   */
  bool WriteDifference(const char* path);

  /**
   * Write the picture that is judged, to look at or as a new baseline: .exr gets all arrays without loss, .png takes bytes as they are and
   * rounds floats. Return whether it was written.
   */
  bool WriteImage(const char* path);

protected:
  vtkStratusImageTest();
  ~vtkStratusImageTest() override;

  char* FileName = nullptr;
  char* BaselineFileName = nullptr;
  bool Exact = false;
  double Tolerance = -1.0;
  double MaximumDifference = -1.0;
  double LeastSSIM = -2.0;

  bool Failed = false;
  int Size[2] = { 0, 0 };
  vtkIdType NumberOfDifferentPixels = 0;
  vtkIdType NumberOfLitPixels = 0;
  double LargestDifference = 0.0;
  int LargestDifferencePixel[2] = { 0, 0 };
  double RootMeanSquare = 0.0;
  double SSIM = -2.0;

private:
  vtkStratusImageTest(const vtkStratusImageTest&) = delete;
  void operator=(const vtkStratusImageTest&) = delete;

  struct vtkInternals;
  void CheckLimits() const;
  void Load();
  void Measure();
  std::string Judge() const;
  bool Write(vtkImageData* image, const char* path);

  std::unique_ptr<vtkInternals> Internals;
};

#endif
