// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim/world/ray_shapes.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// The surface that a ray hits.
struct Hit {
  double distance_m = 0.0;
  /// Points to the side from which the ray comes.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double reflectivity = kDefaultReflectivity;
};

/// Finds the first surface that a ray hits: of objects (with a tree of bounding boxes), of the
/// floor with its pits, and of actors. Surfaces have two sides.
class RayCaster {
 public:
  explicit RayCaster(const World& world);

  /// The first hit; empty if there is none up to `max_range_m`.
  [[nodiscard]] std::optional<Hit> cast(const Ray& ray, double max_range_m,
                                        std::span<const ActorState> actors = {}) const;

 private:
  struct Item {
    RayShape shape;
    double reflectivity = kDefaultReflectivity;
  };
  /// A leaf contains items [first, first + count); an inner node (count 0) has its children at the
  /// next index and at `first`.
  struct Node {
    Bounds bounds;
    std::size_t first = 0;
    std::size_t count = 0;
  };
  struct Nearest {
    double distance_m = 0.0;
    const Item* item = nullptr;
  };

  void add(const Object& object);
  std::size_t build(std::size_t first, std::size_t last);
  void find_item(const Ray& ray, Nearest& nearest) const;
  void test_leaf(const Node& node, const Ray& ray, Nearest& nearest) const;
  [[nodiscard]] std::optional<Hit> cast_ground(const Ray& ray, double max_range_m) const;

  std::vector<Item> items_;
  std::vector<Node> nodes_;
  std::vector<Pit> pits_;
  double floor_reflectivity_;
};

[[nodiscard]] Bounds bounds_of(const Object& object);

/// The two triangles of a ramp.
[[nodiscard]] Mesh to_mesh(const Ramp& ramp);

}  // namespace nodmap::sim
