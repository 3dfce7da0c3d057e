// SPDX-License-Identifier: BSD-3-Clause
// Helpers of the tests of the mapper's refusals: a scene is broken, refused with one error, and mended. A scene whose settings have no
// meaning is drawn without them, with one warning.
#ifndef refusal_testing_h
#define refusal_testing_h

#include "mapper_testing.h"

inline bool IsBlack(Scene& scene)
{
  const std::vector<unsigned char> bytes = scene.Bytes();
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    if (bytes[4 * p] || bytes[4 * p + 1] || bytes[4 * p + 2]) {
      return false;
    }
  }
  return true;
}

// Breaks a scene that has been drawn, expects one error that contains `word`, mends the scene, and expects the first picture again.
inline void Refused(const char* what, const char* word, const std::function<void(Scene&)>& breaks, const std::function<void(Scene&)>& mends)
{
  Scene scene(64, 48);
  const std::vector<float> before = scene.Picture();
  CHECK(scene.Errors->Count == 0, "%s: %s", what, scene.Errors->Text.c_str());
  breaks(scene);
  scene.Render();
  CHECK(scene.Errors->Count == 1, "%s: %d errors", what, scene.Errors->Count);
  CHECK(scene.Errors->Has(word), "%s: '%s' says nothing of '%s'", what, scene.Errors->Text.c_str(), word);
  const std::string last = scene.Mapper->GetLastError();
  CHECK(!last.empty() && scene.Errors->Has(last.c_str()), "%s: '%s' is the last error", what, last.c_str());
  CHECK(IsBlack(scene), "%s: something is drawn", what);
  CHECK(!scene.Mapper->GetLastImage(), "%s: the picture before it is handed out", what);
  scene.Render();
  CHECK(scene.Errors->Count == 1, "%s: reported again with every picture", what);
  CHECK(*scene.Mapper->GetLastError(), "%s: the last error is lost when it repeats", what);
  mends(scene);
  CHECK(scene.Picture() == before, "%s: the picture after it is another", what);
  CHECK(!*scene.Mapper->GetLastError(), "%s: still '%s'", what, scene.Mapper->GetLastError());
  CHECK(scene.Errors->Count == 1, "%s: still refused: %s", what, scene.Errors->Text.c_str());
}

// Draws a prepared scene, then with settings that have no meaning in it. Expects the same picture, and one warning that contains `word`.
inline void LeftOut(
  const char* what, const char* word, const std::function<void(Scene&)>& prepares, const std::function<void(Scene&)>& sets)
{
  Scene scene(64, 48);
  vtkNew<ErrorObserver> warnings;
  scene.Mapper->AddObserver(vtkCommand::WarningEvent, warnings);
  prepares(scene);
  const std::vector<float> before = scene.Picture();
  CHECK(scene.Errors->Count == 0 && !before.empty() && !IsBlack(scene), "%s: %s", what, scene.Errors->Text.c_str());
  CHECK(warnings->Count == 0, "%s: warns before: %s", what, warnings->Text.c_str());
  sets(scene);
  CHECK(scene.Picture() == before, "%s: the picture is another", what);
  CHECK(scene.Errors->Count == 0, "%s: %s", what, scene.Errors->Text.c_str());
  CHECK(warnings->Count == 1 && warnings->Has(word), "%s: %d warnings, '%s' says nothing of '%s'", what, warnings->Count,
    warnings->Text.c_str(), word);
  scene.Volume->GetProperty()->Modified();
  scene.Render();
  CHECK(warnings->Count == 1, "%s: warns again: %s", what, warnings->Text.c_str());
}

#endif
