// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRankBlend.h"

#include "vtkMultiProcessController.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace {

struct Rectangle {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0; // pixels [x0, x1) x [y0, y1)

  size_t values() const { return x0 < x1 && y0 < y1 ? 4 * static_cast<size_t>(x1 - x0) * static_cast<size_t>(y1 - y0) : 0; }
  Rectangle rows(int from, int to) const { return { x0, x1, std::max(y0, from), std::min(y1, to) }; }
};

// Rows that a rank blends: [first_row(rank), first_row(rank + 1)).
int first_row(int rank, int ranks, int height)
{
  return static_cast<int>(static_cast<long long>(height) * rank / ranks);
}

Rectangle find_shown(const std::vector<unsigned short>& picture, const int size[2])
{
  Rectangle shown = { size[0], 0, size[1], 0 };
  for (int y = 0; y < size[1]; ++y) {
    const unsigned short* row = picture.data() + 4 * static_cast<size_t>(y) * static_cast<size_t>(size[0]);
    const auto any = [row](int x) { return row[4 * x] || row[4 * x + 1] || row[4 * x + 2] || row[4 * x + 3]; };
    int from = 0, to = size[0];
    while (from < to && !any(from)) {
      ++from;
    }
    while (to > from && !any(to - 1)) {
      --to;
    }
    if (from < to) {
      shown = { std::min(shown.x0, from), std::max(shown.x1, to), std::min(shown.y0, y), y + 1 };
    }
  }
  return shown;
}

void cut(const std::vector<unsigned short>& picture, int width, const Rectangle& part, std::vector<unsigned short>& values)
{
  for (int y = part.y0; y < part.y1 && part.x0 < part.x1; ++y) {
    const auto row = picture.begin() + 4 * static_cast<ptrdiff_t>(y) * width;
    values.insert(values.end(), row + 4 * static_cast<ptrdiff_t>(part.x0), row + 4 * static_cast<ptrdiff_t>(part.x1));
  }
}

// Puts a part of a picture behind what is there.
void blend_behind(std::vector<float>& sums, int width, int first, const Rectangle& part, const unsigned short* values)
{
  for (int y = part.y0; y < part.y1; ++y) {
    float* to = sums.data() + 4 * (static_cast<size_t>(y - first) * static_cast<size_t>(width) + static_cast<size_t>(part.x0));
    for (int x = part.x0; x < part.x1; ++x, to += 4, values += 4) {
      const float left = (1.0f - to[3]) / 65535.0f;
      for (int c = 0; c < 4; ++c) {
        to[c] += left * static_cast<float>(values[c]);
      }
    }
  }
}

// ParaView blends the bytes over the background, and rounds once more. The colours are such that this gives the rounded colours of the
// whole. Only alpha is rounded to the nearest.
void round_over(const std::vector<float>& sums, const float background[3], std::vector<unsigned char>& rounded)
{
  for (size_t pixel = 0; pixel < sums.size(); pixel += 4) {
    const float alpha = std::floor(255.0f * std::min(sums[pixel + 3], 1.0f) + 0.5f);
    for (size_t c = 0; c < 3; ++c) {
      const float whole = std::floor(255.0f * sums[pixel + c] + (1.0f - sums[pixel + 3]) * background[c] + 0.5f);
      const float rest = (255.0f - alpha) / 255.0f * background[c];
      rounded[pixel + c] = static_cast<unsigned char>(std::min(std::max(std::floor(whole - rest + 0.5f), 0.0f), 255.0f));
    }
    rounded[pixel + 3] = static_cast<unsigned char>(alpha);
  }
}
} // namespace

bool stratus::blend_ranks(vtkMultiProcessController* controller, const std::vector<int>& order, const int size[2],
  const std::vector<std::vector<unsigned short>>& layers, const float background[3], std::vector<unsigned char>& bytes)
{
  const int ranks = controller->GetNumberOfProcesses(), me = controller->GetLocalProcessId(), width = size[0], height = size[1];
  const size_t count = layers.size();
  std::vector<Rectangle> mine, shown(count * static_cast<size_t>(ranks)); // rank by rank
  for (const auto& layer : layers) {
    mine.push_back(find_shown(layer, size));
  }
  controller->AllGather(&mine[0].x0, &shown[0].x0, 4 * static_cast<vtkIdType>(count));

  const int first = first_row(me, ranks, height), last = first_row(me + 1, ranks, height);
  std::vector<size_t> begins(shown.size() + 1, 0);
  size_t most = 0; // values that go to one rank
  for (size_t part = 0; part < shown.size(); ++part) {
    begins[part + 1] = begins[part] + shown[part].rows(first, last).values();
  }
  for (int owner = 0; owner < ranks; ++owner) {
    size_t values = 0;
    for (const Rectangle& part : mine) {
      values += part.rows(first_row(owner, ranks, height), first_row(owner + 1, ranks, height)).values();
    }
    most = std::max(most, values);
  }
  std::vector<vtkIdType> lengths(static_cast<size_t>(ranks)), offsets(static_cast<size_t>(ranks));
  std::vector<unsigned short> parts, sent;
  std::vector<float> sums;
  std::vector<unsigned char> rounded, whole;
  bool room = true;
  try {
    sent.reserve(most);
    parts.resize(begins.back());
    sums.assign(4 * static_cast<size_t>(width) * static_cast<size_t>(last - first), 0.0f);
    rounded.resize(sums.size());
    whole.assign(4 * static_cast<size_t>(width) * static_cast<size_t>(height), 0);
  } catch (const std::bad_alloc&) {
    room = false;
  }
  const int own_room = room;
  int all_room = 0;
  controller->AllReduce(&own_room, &all_room, 1, vtkCommunicator::MIN_OP);
  if (!all_room) {
    return room;
  }
  for (int owner = 0; owner < ranks; ++owner) {
    const int from = first_row(owner, ranks, height), to = first_row(owner + 1, ranks, height);
    vtkIdType all = 0;
    for (size_t rank = 0; rank < lengths.size(); ++rank) {
      lengths[rank] = 0;
      for (size_t layer = 0; layer < count; ++layer) {
        lengths[rank] += static_cast<vtkIdType>(shown[rank * count + layer].rows(from, to).values());
      }
      offsets[rank] = all;
      all += lengths[rank];
    }
    sent.clear();
    for (size_t layer = 0; layer < count; ++layer) {
      cut(layers[layer], width, mine[layer].rows(from, to), sent);
    }
    controller->GatherV(sent.data(), parts.data(), static_cast<vtkIdType>(sent.size()), lengths.data(), offsets.data(), owner);
  }

  for (size_t layer = 0; layer < count; ++layer) {
    for (const int rank : order) {
      const size_t part = static_cast<size_t>(rank) * count + layer;
      if (begins[part + 1] > begins[part]) {
        blend_behind(sums, width, first, shown[part].rows(first, last), parts.data() + begins[part]);
      }
    }
  }

  round_over(sums, background, rounded);
  for (int rank = 0; rank < ranks; ++rank) {
    const size_t r = static_cast<size_t>(rank);
    offsets[r] = 4 * static_cast<vtkIdType>(width) * first_row(rank, ranks, height);
    lengths[r] = 4 * static_cast<vtkIdType>(width) * first_row(rank + 1, ranks, height) - offsets[r];
  }
  controller->GatherV(rounded.data(), whole.data(), static_cast<vtkIdType>(rounded.size()), lengths.data(), offsets.data(), 0);
  bytes.swap(whole);
  return room;
}
