// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/likelihood_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace nodmap::slam2d {
namespace {

constexpr int kStampCells = 2;  // on each side of the one a point lies in
constexpr double kStampSigmaCells = 1.0;

// 16 bytes that are added at once. Eigen has no such type of bytes.
using Bytes = std::uint8_t __attribute__((vector_size(LikelihoodGrid::kRowChunk)));
constexpr int kTopStep = 17;             // 255 in 15 steps
constexpr std::size_t kCheckEvery = 16;  // points: whether the sum can still be reached

}  // namespace

LikelihoodGrid::LikelihoodGrid(std::span<const Eigen::Vector2d> points, double cell_size_m,
                               double max_range_m)
    : cell_size_m_(cell_size_m) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double n = 0.0;
  for (const Eigen::Vector2d& p : points) {
    if (p.allFinite()) {
      mean += p;
      n += 1.0;
    }
  }
  mean /= std::max(1.0, n);
  std::vector<Eigen::Vector2d> used;
  Eigen::AlignedBox2d box(mean);
  for (const Eigen::Vector2d& p : points) {
    if (p.allFinite() && (p - mean).norm() <= max_range_m) {
      used.push_back(p);
      box.extend(p);
    }
  }
  draw(used, box);
}

LikelihoodGrid::LikelihoodGrid(std::span<const Eigen::Vector2d> points, double cell_size_m,
                               std::span<const Eigen::Vector2d> allowed)
    : cell_size_m_(cell_size_m) {
  Eigen::AlignedBox2d walls;
  for (const Eigen::Vector2d& p : points) {
    walls.extend(p);
  }
  Eigen::AlignedBox2d box = walls;
  for (const Eigen::Vector2d& place : allowed) {
    box.extend(place);
  }
  if (!walls.isEmpty()) {
    // By whole cells: where the cells lie depends on the walls alone.
    box.min() = walls.min().array() -
                cell_size_m * ((walls.min() - box.min()).array() / cell_size_m).ceil();
  }
  draw(points, box.isEmpty() ? Eigen::AlignedBox2d(Eigen::Vector2d::Zero()) : box);
  set_allowed(allowed);
}

// `box`: what the grid covers at least.
void LikelihoodGrid::draw(std::span<const Eigen::Vector2d> points, const Eigen::AlignedBox2d& box) {
  // Windows that reach into the grid begin before it.
  const double before = ((1 << kTopLevel) + kStampCells) * cell_size_m_;
  origin_ = box.min().array() - before;
  const Eigen::Vector2i size = cell_of(box.max()).array() + kStampCells + 1;
  width_ = size.x();
  height_ = size.y();
  levels_.assign(1, std::vector<std::uint8_t>(static_cast<std::size_t>(width_) *
                                              static_cast<std::size_t>(height_)));
  for (const Eigen::Vector2d& p : points) {
    stamp(p);
  }
  add_windows(levels_);
  add_top_table();
}

Eigen::Vector2i LikelihoodGrid::cell_of(const Eigen::Vector2d& p) const {
  constexpr double kFar = 1e6;  // cells; beyond any grid
  const Eigen::Array2d cells = ((p - origin_) / cell_size_m_).array().floor();
  // NaN counts as far away, too.
  return cells.isNaN().select(-kFar, cells.max(-kFar).min(kFar)).cast<int>();
}

void LikelihoodGrid::stamp(const Eigen::Vector2d& p) {
  const Eigen::Vector2i home = cell_of(p);
  for (int y = home.y() - kStampCells; y <= home.y() + kStampCells; ++y) {
    for (int x = home.x() - kStampCells; x <= home.x() + kStampCells; ++x) {
      const Eigen::Vector2d middle = origin_ + cell_size_m_ * Eigen::Vector2d(x + 0.5, y + 0.5);
      const double sigmas = (middle - p).norm() / (kStampSigmaCells * cell_size_m_);
      const auto value = static_cast<std::uint8_t>(255.0 * std::exp(-0.5 * sigmas * sigmas));
      std::uint8_t& cell =
          levels_[0][static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                     static_cast<std::size_t>(x)];
      cell = std::max(cell, value);
    }
  }
}

// A window consists of the four windows of half its width that begin in its quarters.
void LikelihoodGrid::add_windows(std::vector<Level>& levels) const {
  const auto width = static_cast<std::size_t>(width_);
  const auto height = static_cast<std::size_t>(height_);
  while (levels.size() < kLevels) {
    const Level& below = levels.back();
    const auto half = static_cast<std::size_t>(1) << (levels.size() - 1);
    Level rows = below;  // the largest of two beside each other
    for (std::size_t y = 0; y < height; ++y) {
      std::uint8_t* row = rows.data() + y * width;
      for (std::size_t x = 0; x + half < width; ++x) {
        row[x] = std::max(row[x], below[y * width + x + half]);
      }
    }
    Level level = rows;
    for (std::size_t i = 0; i + half * width < level.size(); ++i) {
      level[i] = std::max(rows[i], rows[i + half * width]);
    }
    levels.push_back(std::move(level));
  }
}

void LikelihoodGrid::set_allowed(std::span<const Eigen::Vector2d> places) {
  Level allowed(levels_[0].size());
  for (const Eigen::Vector2d& place : places) {
    const Eigen::Vector2i cell = cell_of(place);
    allowed[static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(cell.x())] = 1;
  }
  allowed_.clear();
  allowed_.push_back(std::move(allowed));
  add_windows(allowed_);
}

void LikelihoodGrid::add_top_table() {
  top_width_ = kRowChunk + (width_ + kTopCells - 1) / kTopCells + kRowChunk;
  top_height_ = (height_ + kTopCells - 1) / kTopCells;
  top_table_.assign(static_cast<std::size_t>(kTopCells * top_width_) *
                        static_cast<std::size_t>(kTopCells * top_height_),
                    0);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      top_table_[static_cast<std::size_t>(top_cell(x, y).offset)] =
          static_cast<std::uint8_t>((largest(kTopLevel, x, y) + kTopStep - 1) / kTopStep);
    }
  }
}

// Shifts round down, below zero too.
LikelihoodGrid::TopCell LikelihoodGrid::top_cell(int x, int y) const {
  const int column = kRowChunk + (x >> kTopLevel);
  const int row = y >> kTopLevel;
  const int table = (y & (kTopCells - 1)) * kTopCells + (x & (kTopCells - 1));
  return {column, row,
          (std::ptrdiff_t{table} * top_height_ + row) * std::ptrdiff_t{top_width_} + column};
}

std::vector<LikelihoodGrid::TopCell> LikelihoodGrid::top_cells(
    std::span<const Eigen::Vector2i> cells, int x, int y) const {
  std::vector<TopCell> prepared;
  prepared.reserve(cells.size());
  for (const Eigen::Vector2i& cell : cells) {
    prepared.push_back(top_cell(cell.x() + x, cell.y() + y));
  }
  return prepared;
}

// Sums of as many values of 4 bits as a byte holds, then of 16 bits.
LikelihoodGrid::RowChunk LikelihoodGrid::top_bounds(std::span<const TopCell> cells, int column,
                                                    int row) const {
  constexpr std::size_t kInByte = 17;  // times 15 is 255
  const std::ptrdiff_t corner = std::ptrdiff_t{row} * top_width_ + column;
  const auto height = static_cast<unsigned>(top_height_);
  const auto columns = static_cast<unsigned>(top_width_ - kRowChunk);
  RowChunk sums{};
  for (std::size_t begin = 0; begin < cells.size(); begin += kInByte) {
    Bytes bytes{};
    for (const TopCell& cell : cells.subspan(begin, std::min(kInByte, cells.size() - begin))) {
      if (static_cast<unsigned>(cell.row + row) < height &&
          static_cast<unsigned>(cell.column + column) <= columns) {
        Bytes shifted;
        std::memcpy(&shifted, top_table_.data() + (corner + cell.offset), sizeof(shifted));
        bytes += shifted;
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums[i] = static_cast<std::uint16_t>(sums[i] + kTopStep * bytes[i]);
    }
  }
  return sums;
}

LikelihoodGrid::Quarters LikelihoodGrid::sums_of_quarters(int level,
                                                          std::span<const Eigen::Vector2i> cells,
                                                          int x, int y, int min_sum) const {
  const int half = 1 << level;
  const std::uint8_t* const values = levels_[static_cast<std::size_t>(level)].data();
  const auto width = static_cast<std::size_t>(width_);
  const auto half_size = static_cast<std::size_t>(half);
  // Within these limits all four quarters begin inside the grid.
  const auto columns = static_cast<unsigned>(width_ - half);
  const auto rows = static_cast<unsigned>(height_ - half);
  Quarters sums{};
  for (std::size_t begin = 0; begin < cells.size(); begin += kCheckEvery) {
    const std::size_t end = std::min(begin + kCheckEvery, cells.size());
    for (std::size_t i = begin; i < end; ++i) {
      const int cell_x = cells[i].x() + x;
      const int cell_y = cells[i].y() + y;
      const auto column = static_cast<unsigned>(cell_x);
      const auto row = static_cast<unsigned>(cell_y);
      if (column < columns && row < rows) {
        const std::uint8_t* const value = values + std::size_t{row} * width + column;
        sums[0] += value[0];
        sums[1] += value[half_size * width];
        sums[2] += value[half_size];
        sums[3] += value[half_size * width + half_size];
      } else {
        sums[0] += largest(level, cell_x, cell_y);
        sums[1] += largest(level, cell_x, cell_y + half);
        sums[2] += largest(level, cell_x + half, cell_y);
        sums[3] += largest(level, cell_x + half, cell_y + half);
      }
    }
    const int best = std::max(std::max(sums[0], sums[1]), std::max(sums[2], sums[3]));
    if (best + 255 * static_cast<int>(cells.size() - end) < min_sum) {
      break;
    }
  }
  return sums;
}

}  // namespace nodmap::slam2d
