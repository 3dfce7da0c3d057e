// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFReader.h"

#include "vtkStratusNetCDFFile.h"

#include "vtkDataSet.h"

vtkStratusNetCDFReader::~vtkStratusNetCDFReader()
{
  this->SetSelection(nullptr);
}

std::string vtkStratusNetCDFReader::Inspect()
{
  const vtkStratusNetCDFFile file(this->FileName, this->Selection ? this->Selection : "");
  return this->InspectFile(file);
}

void vtkStratusNetCDFReader::Build(size_t step, vtkDataObject* output)
{
  const vtkStratusNetCDFFile file(this->FileName, this->Selection ? this->Selection : "");
  this->BuildFile(file, step, vtkDataSet::SafeDownCast(output));
}

void vtkStratusNetCDFReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Selection: " << (this->Selection ? this->Selection : "(none)") << "\n";
}
