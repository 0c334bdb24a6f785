// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/point_index.hpp"

#include <nanoflann.hpp>

namespace nodmap::slam6d {
namespace {

constexpr std::size_t kLeafSize = 10;

// What nanoflann sees of one tree: a contiguous range of all points.
struct Range {
  const std::vector<Eigen::Vector3d>* points = nullptr;
  std::size_t first = 0;
  std::size_t count = 0;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return count; }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return (*points)[first + i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  [[nodiscard]] bool kdtree_get_bbox(Box& /*unused*/) const {
    return false;
  }
};

using Metric = nanoflann::L2_Simple_Adaptor<double, Range>;
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Range, 3, std::size_t>;

struct Tree {
  Tree(const std::vector<Eigen::Vector3d>& points, std::size_t first, std::size_t count)
      : range{&points, first, count},
        kd_tree(3, range, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}

  Range range;
  KdTree kd_tree;
};

// The k best so far, over several trees: counts a tree's points in the order of all points, and
// starts with a bound instead of infinity. The interface is nanoflann's.
class BestOf {
 public:
  BestOf(std::span<std::size_t> indices, std::span<double> sq_distances, double sq_bound)
      : found_(indices.size()) {
    found_.init(indices.data(), sq_distances.data());
    sq_distances.back() = sq_bound;
  }

  void set_first(std::size_t first) { first_ = first; }
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] bool full() const { return found_.full(); }
  [[nodiscard]] double worstDist() const {  // NOLINT(readability-identifier-naming): nanoflann's
    return found_.worstDist();
  }
  bool addPoint(double sq_distance, std::size_t i) {  // NOLINT(readability-identifier-naming): same
    return found_.addPoint(sq_distance, first_ + i);
  }

 private:
  nanoflann::KNNResultSet<double, std::size_t> found_;
  std::size_t first_ = 0;
};

}  // namespace

struct PointIndex::Forest {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::unique_ptr<Tree>> trees;  // contiguous ranges, larger ones first

  void search(const Eigen::Vector3d& p, BestOf& best) const {
    for (const auto& tree : trees) {
      best.set_first(tree->range.first);
      tree->kd_tree.findNeighbors(best, p.data(), nanoflann::SearchParams());
    }
  }
};

PointIndex::PointIndex() : forest_(std::make_unique<Forest>()) {}
PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

void PointIndex::add(std::span<const Eigen::Vector3d> points) {
  if (points.empty()) {
    return;
  }
  auto& all = forest_->points;
  auto& trees = forest_->trees;
  std::size_t first = all.size();
  all.insert(all.end(), points.begin(), points.end());
  while (!trees.empty() && trees.back()->range.count <= 2 * (all.size() - first)) {
    first = trees.back()->range.first;
    trees.pop_back();
  }
  trees.push_back(std::make_unique<Tree>(all, first, all.size() - first));
}

std::optional<PointIndex::Neighbour> PointIndex::nearest(const Eigen::Vector3d& p,
                                                         double max_distance_m) const {
  std::size_t index = 0;
  double sq_distance = 0.0;
  BestOf best({&index, 1}, {&sq_distance, 1}, max_distance_m * max_distance_m);
  forest_->search(p, best);
  if (best.size() == 0) {
    return std::nullopt;
  }
  return Neighbour{index, sq_distance};
}

std::vector<PointIndex::Neighbour> PointIndex::nearest_k(const Eigen::Vector3d& p,
                                                         std::size_t k) const {
  if (k == 0) {
    return {};
  }
  std::vector<std::size_t> indices(k);
  std::vector<double> sq_distances(k);
  BestOf best(indices, sq_distances, std::numeric_limits<double>::max());
  forest_->search(p, best);
  std::vector<Neighbour> neighbours(best.size());
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    neighbours[i] = {indices[i], sq_distances[i]};
  }
  return neighbours;
}

std::span<const Eigen::Vector3d> PointIndex::points() const {
  return forest_->points;
}

}  // namespace nodmap::slam6d
