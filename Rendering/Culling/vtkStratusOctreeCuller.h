// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusOctreeCuller
 * @brief   leaves out what the camera does not see, by an octree of the props' bounds
 *
 * Takes the place of the vtkFrustumCoverageCuller that each renderer has, and keeps what that one does: render times by coverage, the
 * order, the total; that one asks every prop for its bounds in every frame. This one keeps the bounds in an octree that is split where the
 * frustum's border runs (Li & Huang 2024), and asks an actor only after something that its bounds come from was modified: the actor, its
 * mapper, the data, or any algorithm upstream. That is known of vtkActor with a vtkPolyDataMapper or a vtkDataSetMapper, not of classes
 * that derive from them; all other props (volumes, assemblies, followers ...) are asked in every frame. So a prop that was added, moved,
 * hidden, removed or fed anew is right in the next frame, seen or not.
 *
 * A prop is kept if its box reaches into each of the six half-spaces of the camera, the window taken Margin pixels wider. Props without
 * bounds and those with UseBounds off are always kept. One culler may serve several renderers; each has an octree of its own.
 *
 *     vtkStratusOctreeCuller::Install(renderer);
 *
 * @sa vtkFrustumCoverageCuller
 */
#ifndef vtkStratusOctreeCuller_h
#define vtkStratusOctreeCuller_h

#include "StratusRenderingCullingModule.h" // For export macro
#include "vtkCuller.h"

#include <memory> // For std::unique_ptr

class vtkPolyData;

class STRATUSRENDERINGCULLING_EXPORT vtkStratusOctreeCuller : public vtkCuller
{
public:
  static vtkStratusOctreeCuller* New();
  vtkTypeMacro(vtkStratusOctreeCuller, vtkCuller);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Install puts a culler in place of the renderer's vtkFrustumCoverageCuller, takes over its coverages and order, and returns it; the
   * renderer owns it. Where one is, it is returned. Uninstall goes the way back. Other cullers stay.
   */
  static vtkStratusOctreeCuller* Install(vtkRenderer* renderer);
  static void Uninstall(vtkRenderer* renderer);
  //@}

  //@{
  /**
   * The promise that this culler's Modified() is called whenever bounds may have changed; they are asked for then, and of props that are
   * new in the list. Props added, removed, shown or hidden need no call. Default off.
   */
  vtkSetMacro(StaticProps, bool);
  vtkGetMacro(StaticProps, bool);
  vtkBooleanMacro(StaticProps, bool);
  //@}

  //@{
  /**
   * Pixels by which the window counts as wider on each side, 0..1000: points and lines of twice that width reach into it from outside.
   * Coverage is a share of the wider window. Default 8.
   */
  vtkSetClampMacro(Margin, double, 0.0, 1000.0);
  vtkGetMacro(Margin, double);
  //@}

  //@{
  /**
   * Props that cover less of the window than the first are left out, those that cover more than the second get all their time, 0..1.
   * Default 0 and 1.
   */
  vtkSetClampMacro(MinimumCoverage, double, 0.0, 1.0);
  vtkGetMacro(MinimumCoverage, double);
  vtkSetClampMacro(MaximumCoverage, double, 0.0, 1.0);
  vtkGetMacro(MaximumCoverage, double);
  //@}

  enum SortingStyleType { SORT_NONE, SORT_FRONT_TO_BACK, SORT_BACK_TO_FRONT };
  //@{
  /**
   * Order of what is left, by the distance of the bounds' centre from the near plane, as vtkFrustumCoverageCuller's. Default the
   * renderer's.
   */
  vtkSetClampMacro(SortingStyle, int, SORT_NONE, SORT_BACK_TO_FRONT);
  vtkGetMacro(SortingStyle, int);
  void SetSortingStyleToNone() { this->SetSortingStyle(SORT_NONE); }
  void SetSortingStyleToFrontToBack() { this->SetSortingStyle(SORT_FRONT_TO_BACK); }
  void SetSortingStyleToBackToFront() { this->SetSortingStyle(SORT_BACK_TO_FRONT); }
  const char* GetSortingStyleAsString();
  //@}

  //@{
  /**
   * Whether boxes at the frustum's edges are tried by every separating axis, so that nothing beyond them is kept. Default off.
   */
  vtkSetMacro(Exact, bool);
  vtkGetMacro(Exact, bool);
  vtkBooleanMacro(Exact, bool);
  //@}

  enum StopRuleType { STOP_PIXELS, STOP_MANHATTAN, STOP_EUCLID, STOP_STATIC };
  //@{
  /**
   * Which nodes that the frustum's border crosses are split: those larger than Pixels on screen (default), those with L / (DistanceFactor
   * S) < 1 as in the paper or in straight lines, or all, at once. What is seen depends on none of it.
   */
  vtkSetClampMacro(StopRule, int, STOP_PIXELS, STOP_STATIC);
  vtkGetMacro(StopRule, int);
  void SetStopRuleToPixels() { this->SetStopRule(STOP_PIXELS); }
  void SetStopRuleToManhattan() { this->SetStopRule(STOP_MANHATTAN); }
  void SetStopRuleToEuclid() { this->SetStopRule(STOP_EUCLID); }
  void SetStopRuleToStatic() { this->SetStopRule(STOP_STATIC); }
  const char* GetStopRuleAsString();
  //@}

  //@{
  /**
   * Diameter of a node on screen, of a window 1000 pixels high, 1e-3..1e6, default 32; C of the rules by distance, 1e-3..1e6, default 35.
   */
  vtkSetClampMacro(Pixels, double, 1e-3, 1e6);
  vtkGetMacro(Pixels, double);
  vtkSetClampMacro(DistanceFactor, double, 1e-3, 1e6);
  vtkGetMacro(DistanceFactor, double);
  //@}

  //@{
  /**
   * Levels below the root, 0..21, default 21; 0 is a plain list. A node of so many props or fewer is not split, 1..1048576, default 256.
   */
  vtkSetClampMacro(MaximumLevel, int, 0, 21);
  vtkGetMacro(MaximumLevel, int);
  vtkSetClampMacro(LeafProps, int, 1, 1048576);
  vtkGetMacro(LeafProps, int);
  //@}

  //@{
  /**
   * Threads that test boxes, 0..1024, 0 as many as OpenMP takes. Default 1: below a hundred thousand props others cost more than they do.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Of the last call of Cull(), whichever renderer's: props in the list, those left in it, those whose bounds were asked for, milliseconds.
   */
  vtkGetMacro(NumberOfProps, vtkIdType);
  vtkGetMacro(NumberOfVisibleProps, vtkIdType);
  vtkGetMacro(NumberOfPropsAsked, vtkIdType);
  vtkGetMacro(CullTime, double);
  //@}

  //@{
  /**
   * Of a renderer's octree: nodes, bytes that it takes beside the bounds; 0 if it has none.
   */
  vtkIdType GetNumberOfNodes(vtkRenderer* renderer);
  vtkIdType GetBytes(vtkRenderer* renderer);
  //@}

  /**
   * The cells of a renderer's octree as it is now: each one polyline in world coordinates, parents before children. Cell data "Level" (int,
   * the root's is 0; the scalars), "Visibility" (unsigned char: 0 outside the camera's frustum, 1 at its border, 2 inside), "Split"
   * (unsigned char) and "Objects" (vtkIdType: props in its own list). False, and the output as it was, for a renderer that this culler has
   * not served.
   */
  bool GetBoxes(vtkRenderer* renderer, vtkPolyData* output);

  /**
   * Called by the renderer. All props stay in the list where the camera's planes are not finite, while a camera goes into
   * stereo or out of it and has not moved since (it learns of that too late), and, which is an error, where the core fails.
   */
  double Cull(vtkRenderer* renderer, vtkProp** propList, int& listLength, int& initialized) override;

protected:
  vtkStratusOctreeCuller();
  ~vtkStratusOctreeCuller() override;

  bool StaticProps = false;
  double Margin = 8.0;
  double MinimumCoverage = 0.0;
  double MaximumCoverage = 1.0;
  int SortingStyle = SORT_NONE;
  bool Exact = false;
  int StopRule = STOP_PIXELS;
  double Pixels = 32.0;
  double DistanceFactor = 35.0;
  int MaximumLevel = 21;
  int LeafProps = 256;
  int NumberOfThreads = 1;

  vtkIdType NumberOfProps = 0;
  vtkIdType NumberOfVisibleProps = 0;
  vtkIdType NumberOfPropsAsked = 0;
  double CullTime = 0.0;

private:
  vtkStratusOctreeCuller(const vtkStratusOctreeCuller&) = delete;
  void operator=(const vtkStratusOctreeCuller&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
