// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/beam.hpp"

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace nodmap::slam6d {
namespace beam_test {

using Voxels = std::set<VoxelCode>;

constexpr double kResolutionM = 0.05;

struct Ends {
  Eigen::Vector3f p_origin;
  Eigen::Vector3f p_end;
};

Beam make_beam(const Ends& ends) {
  const OctreeGrid grid(kResolutionM);
  return make_beam(grid, ends.p_origin, grid.key_of(ends.p_origin).value(), ends.p_end,
                   grid.key_of(ends.p_end).value());
}

Voxels free_voxels(const CloudVoxels& marked) {
  Voxels voxels;
  for (const auto& cube : marked.cubes()) {
    for (std::size_t word = 0; word < cube->free.size(); ++word) {
      for (unsigned bit = 0; bit < CloudVoxels::kBitsPerWord; ++bit) {
        if ((cube->free[word] >> bit & 1U) != 0U) {
          voxels.insert((cube->code * CloudVoxels::kWords + word) * CloudVoxels::kBitsPerWord +
                        bit);
        }
      }
    }
  }
  return voxels;
}

Voxels walk_alone(const Beam& beam, CloudVoxels& marked) {
  marked.clear();
  walk(beam, marked);
  return free_voxels(marked);
}

Voxels walk_together(const std::vector<Beam>& beams, CloudVoxels& marked) {
  marked.clear();
  walk(beams, marked);
  return free_voxels(marked);
}

// The oracle: the voxels that OctoMap's own function visits.
Voxels walk_with_octomap(const octomap::OcTree& tree, const Ends& ends) {
  const auto to_octomap = [](const Eigen::Vector3f& p) {
    return octomap::point3d(p.x(), p.y(), p.z());
  };
  octomap::KeyRay ray;
  EXPECT_TRUE(tree.computeRayKeys(to_octomap(ends.p_origin), to_octomap(ends.p_end), ray));
  Voxels voxels;
  for (const octomap::OcTreeKey& key : ray) {
    voxels.insert(code_of({key[0], key[1], key[2]}));
  }
  return voxels;
}

// Draws coordinates for which rounding matters: on a border between voxels, in the middle of a
// voxel, just beside either, or equal to the last one, so that beams run along borders, edges and
// diagonals.
class Coordinates {
 public:
  explicit Coordinates(float reach_m) : anywhere_(-reach_m, reach_m) {}

  float draw(std::mt19937& random) {
    const float anywhere = anywhere_(random);
    constexpr double kHalfVoxelM = 0.5 * kResolutionM;
    const double half_voxels = std::round(static_cast<double>(anywhere) / kHalfVoxelM);
    const auto on_border = static_cast<float>(kHalfVoxelM * half_voxels);
    switch (kind_(random)) {
      case 0:
        return last_ = anywhere;
      case 1:
        return last_ = on_border;
      case 2:
        return last_ = std::nextafter(on_border, 1e6F);
      case 3:
        return last_ = std::nextafter(on_border, -1e6F);
      case 4:
        return last_ + 1e-7F;
      default:
        return last_;
    }
  }

 private:
  std::uniform_real_distribution<float> anywhere_;
  std::uniform_int_distribution<int> kind_{0, 5};
  float last_ = 0.0F;
};

std::vector<Ends> draw_ends(float reach_m, int count, std::mt19937& random) {
  Coordinates coordinates(reach_m);
  const OctreeGrid grid(kResolutionM);
  std::vector<Ends> drawn;
  while (static_cast<int>(drawn.size()) < count) {
    Ends ends;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      ends.p_origin[axis] = coordinates.draw(random);
      ends.p_end[axis] = coordinates.draw(random);
    }
    if (grid.key_of(ends.p_origin) != grid.key_of(ends.p_end)) {
      drawn.push_back(ends);
    }
  }
  return drawn;
}

// Each beam is walked alone, and four times at once in the four lanes.
TEST(Beam, VisitsTheSameVoxelsAsOctomap) {
  std::mt19937 random(61);
  const octomap::OcTree tree(kResolutionM);
  CloudVoxels marked;
  for (const float reach_m : {0.2F, 2.0F, 20.0F, 1600.0F}) {
    const int count = reach_m < 100.0F ? 2000 : 20;  // a beam of 1600 m visits 50 000 voxels
    for (const Ends& ends : draw_ends(reach_m, count, random)) {
      const Beam beam = make_beam(ends);
      const Voxels expected = walk_with_octomap(tree, ends);
      ASSERT_TRUE(walk_alone(beam, marked) == expected)
          << ends.p_origin.transpose() << " to " << ends.p_end.transpose();
      ASSERT_TRUE(walk_together({4, beam}, marked) == expected)
          << ends.p_origin.transpose() << " to " << ends.p_end.transpose();
    }
  }
}

// Beams that are walked in groups of four end at different steps, and up to three beams are left
// over.
TEST(Beam, ManyBeamsTogetherVisitTheVoxelsOfEach) {
  std::mt19937 random(62);
  CloudVoxels marked;
  for (int count = 0; count < 64; ++count) {
    std::vector<Beam> beams;
    Voxels expected;
    for (const Ends& ends : draw_ends(3.0F, count, random)) {
      beams.push_back(make_beam(ends));
      expected.merge(walk_alone(beams.back(), marked));
    }
    EXPECT_TRUE(walk_together(beams, marked) == expected) << count;
  }
}

// OctoMap checks for the end after each step; the first steps of four beams do not. This is
// correct, because no beam ends more than three steps before its last one.
TEST(Beam, EndsAtMostThreeStepsEarly) {
  std::mt19937 random(63);
  const octomap::OcTree tree(kResolutionM);
  std::size_t early = 0;
  for (const Ends& ends : draw_ends(2.0F, 20'000, random)) {
    const std::size_t steps = walk_with_octomap(tree, ends).size();
    EXPECT_GE(steps + 3, make_beam(ends).num_steps);
    early += steps < make_beam(ends).num_steps ? 1 : 0;
  }
  EXPECT_GT(early, 0U);
}

// The square of the distance is zero in single precision, so that OctoMap's directions are
// infinite; if two of them are, its walk does not end. Ours must.
TEST(Beam, EndsIfTheSquaredDistanceUnderflows) {
  const float tiny = -1e-30F;
  CloudVoxels marked;
  for (const Eigen::Vector3f& p_end : {Eigen::Vector3f(tiny, 0, 0), Eigen::Vector3f(0, tiny, tiny),
                                       Eigen::Vector3f(tiny, tiny, tiny)}) {
    const Beam beam = make_beam({Eigen::Vector3f::Zero(), p_end});
    const Voxels origin{code_of({0x8000, 0x8000, 0x8000})};
    EXPECT_EQ(walk_alone(beam, marked), origin);
    EXPECT_EQ(walk_together({4, beam}, marked), origin);
  }
}

}  // namespace beam_test
}  // namespace nodmap::slam6d
