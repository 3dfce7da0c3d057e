// SPDX-License-Identifier: BSD-3-Clause
// Pictures of a coarse copy, until the bricks of a large file that the exact picture needs are in memory.
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkCommand.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"

void vtkStratusVolumeMapper::Internals::ReleaseCoarse()
{
  stratus_ray_caster_destroy(this->CoarseCaster);
  stratus_coarse_destroy(this->CoarseCopy);
  this->CoarseCaster = nullptr;
  this->CoarseCopy = nullptr;
  this->CoarseOf = 0;
}

// Decides if the next picture is of the copy: a picture of the volume would have to wait for bricks, and a camera moves, or the program
// draws again at the mapper's event. A mask has as many values as the volume, so that the copy can't have it.
void vtkStratusVolumeMapper::Internals::ChooseCoarse(vtkRenderer* renderer, const stratus_ray_cast_options& options)
{
  const stratus_volume& volume = this->Image.GetVolume();
  vtkRenderWindow* window = renderer->GetRenderWindow();
  const bool moves = window && window->GetDesiredUpdateRate() >= this->Mapper->InteractiveUpdateRate;
  const bool before = this->ShowsCoarse;
  this->ShowsCoarse = false;
  if (!this->Image.GetReads() || volume.identity == 0 || options.mask.bytes || this->IsPath() || renderer->GetSelector()) {
    this->ReleaseCoarse();
    return;
  }
  if (this->CoarseOf != volume.identity) {
    this->ReleaseCoarse();
    this->CoarseOf = volume.identity;
    this->HasToRead = true;
    // Nothing is kept of a file that was never drawn, which is no error.
    if (stratus_coarse_recall(this->Context.Get(), &volume, &this->CoarseCopy) == STRATUS_OK &&
      stratus_ray_caster_create(this->Context.Get(), &this->CoarseCaster) != STRATUS_OK) {
      stratus_coarse_destroy(this->CoarseCopy);
      this->CoarseCopy = nullptr;
    }
  }
  const bool awaited = this->Mapper->HasObserver(vtkCommand::UpdateEvent) && !before;
  this->ShowsCoarse = this->CoarseCopy && this->HasToRead && (moves || awaited);
}

stratus_ray_cast_input vtkStratusVolumeMapper::Internals::InputOf(const stratus_ray_cast_options& options)
{
  stratus_ray_cast_input input = stratus_ray_cast_input();
  input.caster = this->ShowsCoarse ? this->CoarseCaster : this->Caster;
  input.volume = this->ShowsCoarse ? stratus_coarse_volume(this->CoarseCopy) : &this->Image.GetVolume();
  input.transfer = this->Functions.data();
  input.options = &options;
  return input;
}

vtkTypeBool vtkStratusVolumeMapper::GetLastPictureIsCoarse()
{
  return this->Internal->ShowsCoarse ? 1 : 0;
}
