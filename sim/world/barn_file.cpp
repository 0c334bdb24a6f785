// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/barn_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>

#include "common/formats/text_lines.hpp"
#include "common/formats/user_error.hpp"
#include "common/geometry/angle.hpp"
#include "sim/world/world_file.hpp"

namespace nodmap::sim {
namespace {

constexpr double kCylinderRadiusM = 0.075;
constexpr double kCylinderHeightM = 0.5;
// Height of the moving cylinders, above every scanner.
constexpr double kActorHeightM = 1.0;
// More than any world has; a larger count means a broken file.
constexpr int kMaxItems = 10'000;
// How long all actors of a world move, together: a million samples of their paths.
constexpr double kLongestPathsS = 50'000.0;
constexpr double kPathStepS = 0.05;

// The lines of a file that are not comments, with their numbers.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : lines_(file) {}

  bool next() {
    while (lines_.next()) {
      if (!lines_.line().empty() && lines_.line().front() != '#') {
        line_ = std::istringstream(std::string(lines_.line()));
        return true;
      }
    }
    return false;
  }
  // Reads the next line, which must exist.
  void need() {
    if (!next()) {
      fail("the file ends too early");
    }
  }
  template <class Value>
  Value read(const char* what) {
    Value value{};
    if (!(line_ >> value)) {
      fail(std::string("expected ") + what);
    }
    return value;
  }
  double read_number(const char* what) {
    const auto value = read<double>(what);
    if (!(std::abs(value) <= kMaxWorldNumber)) {
      fail(std::string(what) + " is not a number up to 1e5");
    }
    return value;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw formats::UserError(lines_.place() + ": " + what);
  }

 private:
  formats::TextLines lines_;
  std::istringstream line_;
};

// A Catmull-Rom spline through the key frames, with tangents from the neighbouring times, sampled
// so densely that straight lines between the samples deviate by less than a millimetre.
std::vector<Waypoint> spline(const std::vector<Waypoint>& keys) {
  std::vector<Waypoint> path;
  const auto tangent = [&keys](std::size_t i) -> Eigen::Vector2d {
    const Waypoint& before = keys[i > 0 ? i - 1 : 0];
    const Waypoint& after = keys[std::min(i + 1, keys.size() - 1)];
    return (after.position - before.position) / (after.time_s - before.time_s);
  };
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    const double span_s = keys[i + 1].time_s - keys[i].time_s;
    const int steps = std::max(1, static_cast<int>(std::ceil(span_s / kPathStepS)));
    const Eigen::Vector2d m0 = span_s * tangent(i);
    const Eigen::Vector2d m1 = span_s * tangent(i + 1);
    for (int k = 0; k < steps; ++k) {
      const double u = static_cast<double>(k) / steps;
      const double uu = u * u;
      const double uuu = uu * u;
      path.push_back({keys[i].time_s + u * span_s,
                      (2.0 * uuu - 3.0 * uu + 1.0) * keys[i].position + (uuu - 2.0 * uu + u) * m0 +
                          (3.0 * uu - 2.0 * uuu) * keys[i + 1].position + (uuu - uu) * m1});
    }
  }
  path.push_back(keys.back());
  return path;
}

// "radius period_s k name", then k key frames. `left_s`: how long it may move at most; what it does
// is subtracted.
Actor read_actor(Lines& lines, double& left_s) {
  Actor actor;
  actor.radius_m = lines.read_number("a radius");
  actor.height_m = kActorHeightM;
  actor.loop = true;
  static_cast<void>(lines.read_number("a period"));  // the time of the last key frame
  const int count = lines.read<int>("the number of key frames");
  if (actor.radius_m <= 0.0 || count < 1 || count > kMaxItems) {
    lines.fail("invalid radius or number of key frames");
  }
  std::vector<Waypoint> keys;
  for (int i = 0; i < count; ++i) {
    lines.need();
    const double time_s = lines.read_number("a time");
    const double x = lines.read_number("x");
    keys.push_back({time_s, {x, lines.read_number("y")}});
    if (i > 0 && time_s <= keys[keys.size() - 2].time_s) {
      lines.fail("times must ascend");
    }
  }
  left_s -= keys.back().time_s - keys.front().time_s;
  if (left_s < 0.0) {
    lines.fail("the actors of a world may move for 50000 s together, not longer");
  }
  actor.path = spline(keys);
  return actor;
}

// The n objects of a world, cylinders or actors.
void read_objects(Lines& lines, int count, World& world) {
  double left_s = kLongestPathsS;
  for (int i = 0; i < count; ++i) {
    lines.need();
    const auto first = lines.read<std::string>("x or C");
    if (first == "C") {
      world.actors.push_back(read_actor(lines, left_s));
      continue;
    }
    std::istringstream number(first);
    double x = 0.0;
    if (!(number >> x) || !number.eof()) {
      lines.fail("expected x y");
    }
    world.objects.push_back({Cylinder{
        {x, lines.read_number("y"), 0.5 * kCylinderHeightM}, kCylinderRadiusM, kCylinderHeightM}});
  }
}

// Length of the reference path; empty if the file beside the worlds does not contain it.
std::optional<double> reference_path_m(const std::filesystem::path& file, int index) {
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  Lines lines(file);
  while (lines.next()) {
    if (lines.read<int>("an index") == index) {
      return lines.read_number("a length");
    }
  }
  return std::nullopt;
}

// The rules of the challenge: reached within 1 m of the goal, 100 s, no contact.
void set_task(const std::filesystem::path& file, int index, World& world) {
  const bool is_dynamic = !world.actors.empty();
  if (is_dynamic) {
    world.T_world_start = {11.0, 0.0, geometry::kPi};
    world.goals = {{-9.0, 0.0}};
    world.task.reference_path_m = 20.0;
  } else {
    world.T_world_start = {-2.25, 3.0, 0.5 * geometry::kPi};
    world.goals = {{-2.25, 13.0}};
    world.task.reference_path_m = reference_path_m(file.parent_path() / "optimal.txt", index);
  }
  world.task.arrival_radius_m = 1.0;
  world.task.time_limit_s = 100.0;
  world.task.ends_at_contact = true;
}

}  // namespace

World load_barn_world(const std::filesystem::path& file, int index) {
  Lines lines(file);
  while (lines.next()) {
    if (lines.read<std::string>("a line that begins with W") != "W") {
      lines.fail("expected W index n");
    }
    const int found = lines.read<int>("an index");
    const int count = lines.read<int>("the number of objects");
    if (count < 0 || count > kMaxItems) {
      lines.fail("invalid number of objects");
    }
    World world;
    read_objects(lines, count, world);
    if (found == index) {
      world.name = "barn-" + std::to_string(index);
      set_task(file, index, world);
      return world;
    }
  }
  throw formats::UserError(file.string() + ": there is no world " + std::to_string(index));
}

}  // namespace nodmap::sim
