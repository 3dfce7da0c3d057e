// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusUgridReader
 * @brief   reads meshes in layers from netCDF: UGRID, with the conventions of Delft3D FM, SCHISM and FVCOM, and MPAS and ICON
 *
 * The output is a vtkUnstructuredGrid of wedges and hexahedra (prisms of five and six sides, and polyhedra of more) above the faces of a
 * two-dimensional mesh, layer on layer from the bottom up. Points are nodes: number layer * nodes + node, the layers' borders from 0 to the
 * number of layers. Cells are number layer * faces + face.
 *
 * The mesh is a variable of cf_role mesh_topology and dimension 2 with node_coordinates and face_node_connectivity (start_index, _FillValue
 * at the end of smaller faces), or FVCOM's nv, x and y (or lon and lat). Without these it is one of
 * - MPAS (cellsOnVertex or verticesOnCell, lonCell and latCell, or xCell and yCell if on_a_sphere is NO): nodes are the middles of cells,
 * faces are triangles between the cells around a vertex. Values of cells are on nodes, and values of vertices on
 * faces. A vertex at the border, which has fewer cells, is blanked;
 * - cells whose longitudes and latitudes have bounds of three or more corners (ICON): faces are the cells. Corners that are less than six
 *   metres apart are one node.
 *
 * Heights follow, in this order, from
 * - heights of the layers' borders at nodes or faces (SCHISM's zCoordinates or zcor, MPAS' zgrid, ICON's z_ifc, any variable of
 * standard_name altitude or height), or of the layers' middles (zMid, z_mc);
 * - MPAS' layerThickness, from the top, over bottomDepth; maxLevelCell counts the layers that are there;
 * - sigma at the layers' borders or centres (standard_name ocean_sigma_coordinate, FVCOM's siglev and siglay), with the free surface and
 *   the bottom that formula_terms name;
 * - fixed levels: a coordinate of one dimension along the layers, of a length or pressure, or with positive or axis Z, which counts up or
 *   down as in vtkStratusCFReader. The layers' borders are another coordinate of one value more, or the coordinate's bounds, or midway
 *   between its values; the outermost ones then are as far from the outermost value as the next border, but not beyond height 0 if all
 *   values are on one side of it. Layers are cut off at the bottom and the free surface, if the file has them; the uppermost one rises to
 *   the free surface, and Delft3D FM's lowest one reaches the bottom;
 * - one layer between the bottom and the free surface.
 * Free surface and bottom are otherwise found by standard_name and the names that the three models use; values on faces are averaged at
 * nodes. Degrees become metres, as in vtkStratusCFReader. Longitudes that jump by 360 degrees are made continuous. On a mesh around the
 * Earth they keep their values, and faces across the meridian where they jump, 0 or 180 degrees, are cut there. On the plane a pole is a
 * line: a face around it is divided into quadrangles that reach up to it. Nodes and faces that this adds are behind the file's.
 *
 * A variable on faces becomes cell data, one on nodes point data, both of its own name. Values at centres of layers on nodes are
 * interpolated to the layers' borders; values at borders on faces are averaged over the layer; one without layers is repeated in each.
 * Dry cells (a free surface at or below the bottom or without a value, FVCOM's wet_cells, SCHISM's wetdry_elem), cells without thickness
 * and those at nodes without a bottom are blanked by vtkGhostType.
 *
 * Errors are a file without a mesh, nodes' numbers out of range, coordinates without a value, no layers, layers that are upside down, and a
 * time that does not increase.
 *
 * @sa vtkStratusCFReader vtkStratusTetrahedraMapper
 */
#ifndef vtkStratusUgridReader_h
#define vtkStratusUgridReader_h

#include "vtkStratusNetCDFReader.h"

class STRATUSFILTERSIO_EXPORT vtkStratusUgridReader : public vtkStratusNetCDFReader
{
public:
  static vtkStratusUgridReader* New();
  vtkTypeMacro(vtkStratusUgridReader, vtkStratusNetCDFReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Returns whether the file has a mesh that this reader takes, whatever else is wrong with it.
   */
  static bool CanReadFile(const char* name);

protected:
  vtkStratusUgridReader() = default;
  ~vtkStratusUgridReader() override = default;

  std::string InspectFile(const vtkStratusNetCDFModel& file) override;
  void BuildFile(const vtkStratusNetCDFModel& file, size_t step, vtkDataSet* output) override;

private:
  vtkStratusUgridReader(const vtkStratusUgridReader&) = delete;
  void operator=(const vtkStratusUgridReader&) = delete;
};

#endif
