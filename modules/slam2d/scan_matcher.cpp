// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan_matcher.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

constexpr int kMinPairs = 10;

// Of the gate: where the weight of a pair has dropped to a quarter. Between 0.5 (loops that close
// with some drift are missed) and 0.9 (walls seen wrongly pull) the errors on all recordings stay
// within 10 %.
constexpr double kKernelShare = 0.7;

// Of the gate, from one stage to the next; and when a stage is done.
constexpr double kGateDecay = 0.6;
constexpr double kStageDoneShare = 0.1;

// A point where the map is no line tells of both directions, but less surely: corners, foliage.
constexpr double kClutterWeight = 0.3;

// Of the distance of a scan point to the map. The errors of neighbouring points (a wall that is
// not straight, a pose of the map that is off) are alike: ten points tell as much as one would.
constexpr double kPointVarianceM2 = 10.0 * 0.02 * 0.02;

constexpr double kConvergedM = 5e-4;
constexpr double kConvergedRad = 1e-4;

/// The soft weight w_ij of a pair (Geman and McClure): 1 for a perfect pair, 1/4 at `scale`.
double pair_weight(double distance, double scale) {
  const double ratio = distance / scale;
  const double root = 1.0 / (1.0 + ratio * ratio);
  return root * root;
}

}  // namespace

/// All that one pass over the pairs tells.
struct ScanMatcher::Evidence {
  explicit Evidence(const Eigen::Vector2d& reference) : points(reference) {}

  RigidFit points;        // Eq. 3, point to point
  NormalEquations lines;  // Eq. 3, across lines
  int pairs = 0;
  double agreement = 0.0;
  double weight = 0.0;
  double squared_m2 = 0.0;
};

ScanMatcher::Evidence ScanMatcher::find_pairs(const PointMap& map,
                                              std::span<const SurfacePoint> scan,
                                              const geometry::SE2& T_map_base, double gate_m) {
  const double scale = kKernelShare * gate_m;
  const Eigen::Matrix2d R = T_map_base.rotation();
  const Eigen::Vector2d t = T_map_base.translation();
  Evidence evidence(t);
  for (const SurfacePoint& seen : scan) {
    const Eigen::Vector2d lever = R * seen.p;
    const SurfacePoint data{lever + t, R * seen.normal};
    const PointMap::Landmark* model = map.nearest(data, gate_m);
    if (model == nullptr) {
      continue;
    }
    ++evidence.pairs;
    const Eigen::Vector2d offset = data.p - model->point.p;
    const double point_weight = pair_weight(offset.norm(), scale);
    if (model->is_on_line()) {
      const double across = model->normal.dot(data.p - model->centre);
      const double weight = pair_weight(across, scale);
      evidence.points.add(model->point.p, data.p, point_weight);
      evidence.lines.add(model->normal, lever, across, weight);
      evidence.agreement += weight;
      evidence.weight += weight;
      evidence.squared_m2 += weight * across * across;
    } else if (!data.has_normal() || !model->point.has_normal()) {
      // Points that stand alone confirm a pose but do not shape it: along a corridor the far ends
      // of its walls are seen as single points that move with the robot, and would hold it back.
      evidence.agreement += point_weight;
    } else {
      const double weight = kClutterWeight * point_weight;
      evidence.points.add(model->point.p, data.p, weight);
      evidence.lines.add(Eigen::Vector2d::UnitX(), lever, offset.x(), weight);
      evidence.lines.add(Eigen::Vector2d::UnitY(), lever, offset.y(), weight);
      evidence.agreement += point_weight;
      evidence.weight += 2.0 * weight;
      evidence.squared_m2 += weight * offset.squaredNorm();
    }
  }
  return evidence;
}

Eigen::Vector3d ScanMatcher::step(const Evidence& evidence, const geometry::SE2& T_map_base,
                                  double gate_m) const {
  if (params_.metric == Metric::kLines && gate_m <= params_.final_correspondence_m) {
    return evidence.lines.step(params_.weak_direction_share);
  }
  const RigidFit::Solution fit = evidence.points.solve();
  const geometry::SE2 T_next = fit.T_model_data * T_map_base;
  const Eigen::Vector3d step(T_next.x - T_map_base.x, T_next.y - T_map_base.y,
                             fit.T_model_data.yaw);
  return evidence.lines.observability(params_.weak_direction_share).observable * step;
}

Match ScanMatcher::match(const PointMap& map, std::span<const SurfacePoint> scan,
                         const geometry::SE2& T_map_base_guess) const {
  Match match;
  match.T_map_base = T_map_base_guess;
  const double last_gate_m =
      params_.metric == Metric::kLines
          ? std::min(params_.line_correspondence_m, params_.final_correspondence_m)
          : params_.final_correspondence_m;
  double gate_m = std::max(params_.max_correspondence_m, last_gate_m);
  while (match.iterations < params_.iterations) {
    ++match.iterations;
    // Correspondences: w_ij of Eq. 3.
    const Evidence evidence = find_pairs(map, scan, match.T_map_base, gate_m);
    if (evidence.pairs < kMinPairs) {
      match.T_map_base = T_map_base_guess;
      match.weak_directions = 3;
      return match;
    }
    match.weak_directions =
        evidence.lines.observability(params_.weak_direction_share).weak_directions;
    // The minimum of Eq. 3 for these correspondences.
    const Eigen::Vector3d step = this->step(evidence, match.T_map_base, gate_m);
    match.T_map_base = {match.T_map_base.x + step.x(), match.T_map_base.y + step.y(),
                        geometry::normalize_angle(match.T_map_base.yaw + step.z())};
    const double moved_m = step.head<2>().norm();
    const double turned_rad = std::abs(step.z());
    const bool last_stage = gate_m <= last_gate_m;
    if (last_stage && moved_m < kConvergedM && turned_rad < kConvergedRad) {
      break;
    }
    if (moved_m < kStageDoneShare * gate_m && turned_rad < kStageDoneShare * gate_m) {
      gate_m = std::max(last_gate_m, kGateDecay * gate_m);
    }
  }
  judge(map, scan, match);
  return match;
}

// By the d_max of the points: that of the lines is too narrow to tell a scan that is a little off
// from one that is lost.
void ScanMatcher::judge(const PointMap& map, std::span<const SurfacePoint> scan,
                        Match& match) const {
  const Evidence evidence = find_pairs(map, scan, match.T_map_base, params_.final_correspondence_m);
  const auto points = static_cast<double>(scan.size());
  match.pairs = evidence.pairs;
  match.share = evidence.pairs / points;
  match.agreement = evidence.agreement / points;
  match.information = evidence.lines.information(params_.weak_direction_share) / kPointVarianceM2;
  match.rms_m = evidence.weight > 0.0 ? std::sqrt(evidence.squared_m2 / evidence.weight) : 0.0;
}

}  // namespace nodmap::slam2d
