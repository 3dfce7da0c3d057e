// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusZarrReader.h"

#include "vtkStratusZarrFile.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkStratusZarrReader);

int vtkStratusZarrReader::CanReadFile(const char* name)
{
  return name && *name && vtkStratusZarrFile::IsZarr(name) ? 1 : 0;
}

std::unique_ptr<vtkStratusNetCDFModel> vtkStratusZarrReader::OpenFile()
{
  return std::make_unique<vtkStratusZarrFile>(this->FileName, this->Selection ? this->Selection : "");
}

std::string vtkStratusZarrReader::InspectFile(const vtkStratusNetCDFModel& file)
{
  const std::string output = this->Superclass::InspectFile(file);
  const vtkStratusZarrFile& zarr = static_cast<const vtkStratusZarrFile&>(file);
  const vtkStratusNetCDFVariable& chosen = *file.Find(this->ChosenName());
  std::string units[3];
  for (int axis = 0; axis < 3; ++axis) {
    units[axis] = zarr.ImageUnits(chosen, this->AxisNames[axis]);
    this->AxisUnits[axis] = units[axis].empty() ? this->AxisUnits[axis] : units[axis];
  }
  if (!units[0].empty() && units[0] == units[1] && units[0] == units[2]) {
    this->LengthUnits = units[0];
  }
  return output;
}

void vtkStratusZarrReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
