// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusOctreeCuller
 * @brief   leaves out what the camera does not see, by an octree of the props' bounds
 *
 * Replaces the vtkFrustumCoverageCuller that each renderer has, and keeps its results: render times by coverage, the order, the total. The
 * vtkFrustumCoverageCuller asks every prop for its bounds in every frame. This culler keeps the bounds in an octree that is split where the
 * frustum's border runs (Li & Huang 2024). It asks an actor for its bounds only after one of their sources was modified: the actor, its
 * mapper, the data, or any algorithm upstream. The sources are known of a vtkActor with a vtkPolyDataMapper or a vtkDataSetMapper, but not
 * of derived classes; all other props (volumes, assemblies, followers ...) are asked in every frame. So a prop that was added, moved,
 * hidden, removed or given new data is right in the next frame, visible or not. A frame visits a prop for its bounds or, in the frame
 * after, for their sources, not both; and a frame that asks all props, such as the first, splits no node. So no frame does much more than
 * the vtkFrustumCoverageCuller does in every frame.
 *
 * The octree is built and asked on the host, so there is no device to set: a frame changes few of its nodes, and the props' bounds and the
 * list that it fills are the host's.
 *
 * A prop is kept if its box reaches into each of the camera's six half-spaces, with the window widened by Margin pixels. Props without
 * bounds and props with UseBounds off are always kept. One culler may serve several renderers; each has an octree of its own.
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
   * Install() replaces the renderer's vtkFrustumCoverageCuller by a vtkStratusOctreeCuller with the same coverages and order, and returns
   * it. The renderer owns it. If the renderer has one already, Install() returns that. Uninstall() reverses the replacement. Other cullers
   * stay.
   */
  static vtkStratusOctreeCuller* Install(vtkRenderer* renderer);
  static void Uninstall(vtkRenderer* renderer);
  //@}

  //@{
  /**
   * Set/Get the promise that Modified() of this culler is called whenever bounds may have changed. Bounds are then queried only after such
   * a call, and for props that are new in the list. Props added, removed, shown or hidden need no call. Default off.
   */
  vtkSetMacro(StaticProps, bool);
  vtkGetMacro(StaticProps, bool);
  vtkBooleanMacro(StaticProps, bool);
  //@}

  //@{
  /**
   * Set/Get the pixels by which the window is widened on each side, 0..1000. Points and lines of up to twice that width may reach into the
   * window from outside. Coverage is a share of the widened window. Default 8.
   */
  vtkSetClampMacro(Margin, double, 0.0, 1000.0);
  vtkGetMacro(Margin, double);
  //@}

  //@{
  /**
   * Set/Get the share of the window below which a prop is left out, and the share above which a prop gets its full render time, 0..1.
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
   * Set/Get the order of the visible props, by the distance of the bounds' centre from the near plane, as in vtkFrustumCoverageCuller.
   * Default SORT_NONE, the renderer's order.
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
   * Set/Get whether boxes at the frustum's edges are tested along every separating axis, so that no box outside is kept. Default off.
   */
  vtkSetMacro(Exact, bool);
  vtkGetMacro(Exact, bool);
  vtkBooleanMacro(Exact, bool);
  //@}

  enum StopRuleType { STOP_PIXELS, STOP_MANHATTAN, STOP_EUCLID, STOP_STATIC };
  //@{
  /**
   * Set/Get the rule that chooses which nodes across the frustum's border are split. The rule does not change which props are visible.
   * Default STOP_PIXELS.
   * - STOP_PIXELS: nodes larger on screen than Pixels.
   * - STOP_MANHATTAN: nodes with L / (DistanceFactor S) < 1, where L is the distance from the eye to the node's centre and S the
   *   node's diagonal, both measured along the axes as in the paper.
   * - STOP_EUCLID: the same with straight distances.
   * - STOP_STATIC: all nodes, at once.
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
   * Set/Get the parameters of the rules: Pixels, a node's diameter on screen in a window 1000 pixels high, 1e-3..1e6, default 32;
   * DistanceFactor, the C of the rules by distance, 1e-3..1e6, default 35.
   */
  vtkSetClampMacro(Pixels, double, 1e-3, 1e6);
  vtkGetMacro(Pixels, double);
  vtkSetClampMacro(DistanceFactor, double, 1e-3, 1e6);
  vtkGetMacro(DistanceFactor, double);
  //@}

  //@{
  /**
   * Set/Get the levels below the root, 0..21, default 21; 0 is a plain list. Set/Get the number of props up to which a node is not
   * split, 1..1048576, default 256.
   */
  vtkSetClampMacro(MaximumLevel, int, 0, 21);
  vtkGetMacro(MaximumLevel, int);
  vtkSetClampMacro(LeafProps, int, 1, 1048576);
  vtkGetMacro(LeafProps, int);
  //@}

  //@{
  /**
   * Set/Get the number of threads that test boxes, 0..1024. 0 takes as many as OpenMP would. Default 1, because below a hundred thousand
   * props further threads cost more than they save.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Get statistics of the last call of Cull() for any renderer: props in the list, props kept, props whose bounds were queried,
   * milliseconds.
   */
  vtkGetMacro(NumberOfProps, vtkIdType);
  vtkGetMacro(NumberOfVisibleProps, vtkIdType);
  vtkGetMacro(NumberOfPropsAsked, vtkIdType);
  vtkGetMacro(CullTime, double);
  //@}

  //@{
  /**
   * Get the nodes of a renderer's octree, and the bytes that it takes besides the bounds; 0 if it has none.
   */
  vtkIdType GetNumberOfNodes(vtkRenderer* renderer);
  vtkIdType GetBytes(vtkRenderer* renderer);
  //@}

  /**
   * Writes the nodes of a renderer's octree, each as one polyline in world coordinates, parents before children. Cell data: "Level" (int, 0
   * at the root; the scalars), "Visibility" (unsigned char: 0 outside the camera's frustum, 1 at its border, 2 inside), "Split" (unsigned
   * char) and "Objects" (vtkIdType: props in the node's own list). Until a frame does not ask all props, it is one node without extent.
   * Returns false and leaves the output unchanged for a renderer that this culler has not served.
   */
  bool GetBoxes(vtkRenderer* renderer, vtkPolyData* output);

  /**
   * Called by the renderer. All props stay in the list if the camera's planes are not finite, if the camera enters or leaves stereo and has
   * not moved since (it learns of stereo too late), or if the core fails, which is an error.
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
