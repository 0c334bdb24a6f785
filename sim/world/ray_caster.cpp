// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/ray_caster.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace nodmap::sim {
namespace {

constexpr std::size_t kLeafItems = 2;
// Each level halves the items, so this is enough for any number.
constexpr std::size_t kMaxDepth = 64;

Bounds bounds_of(const RayShape& shape) {
  return std::visit([](const auto& s) { return sim::bounds_of(s); }, shape);
}

Eigen::Vector3d center_of(const RayShape& shape) {
  const Bounds bounds = bounds_of(shape);
  return 0.5 * (bounds.min + bounds.max);
}

// Distance at which the ray enters the bounds; kNoHit if that is not before `limit`. The inverse
// of a zero component is infinite.
double entry(const Bounds& bounds, const Eigen::Vector3d& origin, const Eigen::Vector3d& inverse,
             double limit) {
  double enter = 0.0;
  double leave = limit;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double a = (bounds.min[axis] - origin[axis]) * inverse[axis];
    const double b = (bounds.max[axis] - origin[axis]) * inverse[axis];
    // Parallel to the sides and between them (infinity - infinity) or in one (0 * infinity).
    if (std::isnan(a + b)) {
      continue;
    }
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter <= leave) {
    return enter;
  }
  return kNoHit;
}

Hit make_hit(double distance_m, Eigen::Vector3d normal, double reflectivity, const Ray& ray) {
  if (normal.dot(ray.direction) > 0.0) {
    normal = -normal;
  }
  return {distance_m, normal, reflectivity};
}

}  // namespace

Mesh to_mesh(const Ramp& ramp) {
  const Eigen::Vector3d along = ramp.to - ramp.from;
  const Eigen::Vector3d left =
      0.5 * ramp.width_m * Eigen::Vector3d(-along.y(), along.x(), 0.0).normalized();
  return {{ramp.from - left, ramp.to - left, ramp.to + left, ramp.from + left},
          {{0, 1, 2}, {0, 2, 3}}};
}

Bounds bounds_of(const Object& object) {
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    return bounds_of(RayBox(*box));
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
    return bounds_of(RayCylinder(*cylinder));
  }
  const auto* ramp = std::get_if<Ramp>(&object.shape);
  const Mesh mesh = ramp != nullptr ? to_mesh(*ramp) : std::get<Mesh>(object.shape);
  Bounds bounds;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    bounds.extend({vertex, vertex});
  }
  return bounds;
}

RayCaster::RayCaster(const World& world)
    : pits_(world.pits), floor_reflectivity_(world.floor_reflectivity) {
  for (const Object& object : world.objects) {
    add(object);
  }
  if (!items_.empty()) {
    build(0, items_.size());
  }
}

void RayCaster::add(const Object& object) {
  const auto add_mesh = [&](const Mesh& mesh) {
    for (const Eigen::Vector3i& triangle : mesh.triangles) {
      const auto corner = [&](int i) {
        return mesh.vertices[static_cast<std::size_t>(triangle[i])];
      };
      items_.push_back({RayTriangle(corner(0), corner(1), corner(2)), object.reflectivity});
    }
  };
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    items_.push_back({RayBox(*box), object.reflectivity});
  } else if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
    items_.push_back({RayCylinder(*cylinder), object.reflectivity});
  } else if (const auto* ramp = std::get_if<Ramp>(&object.shape)) {
    add_mesh(to_mesh(*ramp));
  } else {
    add_mesh(std::get<Mesh>(object.shape));
  }
}

std::size_t RayCaster::build(std::size_t first, std::size_t last) {
  const std::size_t index = nodes_.size();
  nodes_.push_back({{}, first, last - first});
  Bounds centers;
  for (std::size_t i = first; i < last; ++i) {
    nodes_[index].bounds.extend(bounds_of(items_[i].shape));
    const Eigen::Vector3d center = center_of(items_[i].shape);
    centers.extend({center, center});
  }
  if (last - first <= kLeafItems) {
    return index;
  }
  Eigen::Index axis = 0;
  (centers.max - centers.min).maxCoeff(&axis);
  const auto begin = items_.begin();
  const auto at = [&](std::size_t i) { return begin + static_cast<std::ptrdiff_t>(i); };
  const std::size_t middle = (first + last) / 2;
  std::nth_element(at(first), at(middle), at(last), [axis](const Item& a, const Item& b) {
    return center_of(a.shape)[axis] < center_of(b.shape)[axis];
  });
  build(first, middle);
  const std::size_t right = build(middle, last);
  nodes_[index].first = right;
  nodes_[index].count = 0;
  return index;
}

std::optional<Hit> RayCaster::cast(const Ray& ray, double max_range_m,
                                   std::span<const ActorState> actors) const {
  std::optional<Hit> hit = cast_ground(ray, max_range_m);
  Nearest nearest{hit ? hit->distance_m : max_range_m};
  find_item(ray, nearest);
  if (nearest.item != nullptr) {
    const Eigen::Vector3d p = ray.origin + nearest.distance_m * ray.direction;
    const Eigen::Vector3d normal =
        std::visit([&](const auto& s) { return normal_at(s, p); }, nearest.item->shape);
    hit = make_hit(nearest.distance_m, normal, nearest.item->reflectivity, ray);
  }
  for (const ActorState& actor : actors) {
    const auto test = [&](const Eigen::Vector2d& axis, double radius_m, double bottom_m,
                          double top_m) {
      const RayCylinder cylinder(
          {{axis.x(), axis.y(), 0.5 * (bottom_m + top_m)}, radius_m, top_m - bottom_m});
      const double distance_m = distance_to(cylinder, ray);
      if (distance_m < nearest.distance_m) {
        nearest.distance_m = distance_m;
        const Eigen::Vector3d p = ray.origin + distance_m * ray.direction;
        hit = make_hit(distance_m, normal_at(cylinder, p), actor.reflectivity, ray);
      }
    };
    const double hip_m = actor.legs ? std::min(Legs::kHipM, 0.5 * actor.height_m) : 0.0;
    test(actor.position, actor.radius_m, hip_m, actor.height_m);
    if (actor.legs) {
      test(actor.legs->left, Legs::kRadiusM, 0.0, hip_m);
      test(actor.legs->right, Legs::kRadiusM, 0.0, hip_m);
    }
  }
  return hit;
}

void RayCaster::find_item(const Ray& ray, Nearest& nearest) const {
  if (nodes_.empty()) {
    return;
  }
  struct Visit {
    std::size_t node;
    double enter_m;
  };
  const Eigen::Vector3d inverse = ray.direction.cwiseInverse();
  // Not initialised: it is written before it is read, and clearing it would take as long as the
  // search.
  std::array<Visit, kMaxDepth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  std::size_t depth = 0;
  stack[depth++] = {0, entry(nodes_[0].bounds, ray.origin, inverse, nearest.distance_m)};
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (!(visit.enter_m < nearest.distance_m)) {
      continue;
    }
    const Node& node = nodes_[visit.node];
    if (node.count > 0) {
      test_leaf(node, ray, nearest);
      continue;
    }
    Visit near{visit.node + 1, 0.0};
    Visit far{node.first, 0.0};
    near.enter_m = entry(nodes_[near.node].bounds, ray.origin, inverse, nearest.distance_m);
    far.enter_m = entry(nodes_[far.node].bounds, ray.origin, inverse, nearest.distance_m);
    if (far.enter_m < near.enter_m) {
      std::swap(near, far);
    }
    stack[depth++] = far;
    stack[depth++] = near;
  }
}

void RayCaster::test_leaf(const Node& node, const Ray& ray, Nearest& nearest) const {
  for (std::size_t i = node.first; i < node.first + node.count; ++i) {
    const double distance_m =
        std::visit([&](const auto& s) { return distance_to(s, ray); }, items_[i].shape);
    if (distance_m < nearest.distance_m) {
      nearest = {distance_m, &items_[i]};
    }
  }
}

// Casts a ray onto the floor and, where it is missing, onto the walls and bottoms of the pits.
// Pits that touch are joined: steps are pits of increasing depth.
std::optional<Hit> RayCaster::cast_ground(const Ray& ray, double max_range_m) const {
  if (ray.direction.z() >= 0.0) {
    return std::nullopt;
  }
  double distance_m = -ray.origin.z() / ray.direction.z();
  if (distance_m <= 0.0 || distance_m > max_range_m) {
    return std::nullopt;
  }
  constexpr double kTouchM = 1e-9;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  for (bool deeper = true; deeper;) {
    deeper = false;
    for (const Pit& pit : pits_) {
      const Eigen::Vector2d size = pit.max - pit.min;
      const Eigen::Vector2d center = 0.5 * (pit.min + pit.max);
      const RayBox air(
          Box{{center.x(), center.y(), -0.5 * pit.depth_m}, {size.x(), size.y(), pit.depth_m}});
      // The distance to the exit from this pit, measured from a point slightly ahead, if that is in
      // it.
      const Ray onward{ray.origin + (distance_m + kTouchM) * ray.direction, ray.direction};
      const Eigen::Vector3d within = (onward.origin - air.center).cwiseAbs() - air.half;
      const double more_m = within.maxCoeff() < 0.0 ? distance_to(air, onward) : 0.0;
      if (more_m > kTouchM && more_m < kNoHit) {
        distance_m += kTouchM + more_m;
        normal = normal_at(air, ray.origin + distance_m * ray.direction);
        deeper = true;
      }
    }
  }
  if (distance_m > max_range_m) {
    return std::nullopt;
  }
  return make_hit(distance_m, normal, floor_reflectivity_, ray);
}

}  // namespace nodmap::sim
