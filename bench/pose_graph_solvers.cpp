// SPDX-License-Identifier: BSD-3-Clause
// Holds the pose graph of 2D SLAM against Ceres, and its robust kernel against other ways to live
// with wrong loops. The graph is that of a saved map: its keyframes, the steps between them, and
// its loops. It is optimised from where the steps alone lead, once as it is and once with 30 % of
// wrong loops, which join random keyframes at random relative poses and are as certain as the
// right ones. Prints a table for docs/decisions/007-own-pose-graph.md: the CPU time of both, and
// how far the wrong loops move the keyframes. Call:
//   nodmap-bench-pose-graph MAP ...
// MAP: a folder that nodmap-slam2d --out has written.
#include <ceres/ceres.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/loop_clique.hpp"
#include "bench/timing.hpp"
#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/back_end/saved_map_file.hpp"

namespace {

using namespace nodmap;
using geometry::SE2;
using registration::PoseEdge2d;
using registration::PoseGraph2d;
using Poses = std::vector<SE2>;

constexpr double kWrongShare = 0.3;  // of all loops
constexpr double kInlierChiSquared = registration::PoseSpace<SE2>::kInlierChiSquared;

struct Graph {
  Poses start;  // where the steps alone lead
  std::vector<PoseEdge2d> steps;
  std::vector<PoseEdge2d> loops;
};

// Of a saved map. The frame of a submap is that of its first keyframe.
Graph graph_of(const slam2d::SavedMap& map) {
  Graph graph;
  graph.steps = map.steps;
  graph.start = {map.keyframes.front().T_map_base};
  for (const PoseEdge2d& step : graph.steps) {
    graph.start.push_back(graph.start.back() * step.T_from_to);
  }
  for (const slam2d::SavedMap::Loop& saved : map.loops) {
    PoseEdge2d loop = saved.edge;
    loop.from = map.submaps[loop.from].first_keyframe;
    loop.to = map.submaps[loop.to].first_keyframe;
    loop.may_be_wrong = true;
    graph.loops.push_back(loop);
  }
  for (std::vector<PoseEdge2d>* edges : {&graph.steps, &graph.loops}) {
    for (PoseEdge2d& edge : *edges) {
      edge.information /= map.variance_factor.value();
    }
  }
  return graph;
}

// The graph with wrong loops added, so that they are kWrongShare of all.
Graph with_wrong_loops(Graph graph, std::mt19937& random) {
  const std::vector<PoseEdge2d> right = graph.loops;
  const auto wrong = static_cast<std::size_t>(kWrongShare / (1.0 - kWrongShare) *
                                              static_cast<double>(right.size()));
  std::uniform_int_distribution<std::size_t> node(0, graph.start.size() - 1);
  std::uniform_int_distribution<std::size_t> some(0, right.size() - 1);
  std::normal_distribution<double> offset_m(0.0, 3.0);
  std::uniform_real_distribution<double> yaw_rad(-geometry::kPi, geometry::kPi);
  while (graph.loops.size() < right.size() + wrong) {
    PoseEdge2d loop = right[some(random)];
    loop.from = node(random);
    loop.to = node(random);
    loop.T_from_to = {offset_m(random), offset_m(random), yaw_rad(random)};
    if (loop.from != loop.to) {
      graph.loops.push_back(loop);
    }
  }
  return graph;
}

Poses solve_ours(const Graph& graph) {
  PoseGraph2d solver;
  for (const SE2& pose : graph.start) {
    solver.add_node(pose);
  }
  for (const std::vector<PoseEdge2d>* edges : {&graph.steps, &graph.loops}) {
    for (const PoseEdge2d& edge : *edges) {
      solver.add_edge(edge);
    }
  }
  solver.optimise(true);
  return {solver.nodes().begin(), solver.nodes().end()};
}

// The residual of an edge in units of its standard deviations, for Ceres.
struct EdgeResidual {
  template <class T>
  bool operator()(const T* from, const T* to, T* error) const {
    const T c = cos(from[2]);
    const T s = sin(from[2]);
    const T x = to[0] - from[0];
    const T y = to[1] - from[1];
    const T yaw = to[2] - from[2] - T(measured.yaw);
    const Eigen::Matrix<T, 3, 1> off{c * x + s * y - T(measured.x), -s * x + c * y - T(measured.y),
                                     atan2(sin(yaw), cos(yaw))};
    Eigen::Map<Eigen::Matrix<T, 3, 1>>(error, 3, 1) = root.template cast<T>() * off;
    return true;
  }

  SE2 measured;
  Eigen::Matrix3d root;  // its square is the information
};

// Dynamic covariance scaling (Agarwal et al. 2013) as a loss: the weight of an edge is the square
// of min(1, 2 a / (a + s)), where s is its squared error.
class DynamicScaling : public ceres::LossFunction {
 public:
  void Evaluate(double s, double rho[3]) const override {
    constexpr double a = kInlierChiSquared;
    const bool is_inlier = s <= a;
    rho[0] = is_inlier ? s : a * (3.0 * s - a) / (s + a);
    rho[1] = is_inlier ? 1.0 : 4.0 * a * a / ((s + a) * (s + a));
    rho[2] = is_inlier ? 0.0 : -2.0 * rho[1] / (s + a);
  }
};

using MakeLoss = std::function<ceres::LossFunction*()>;

void add_edges(const std::vector<PoseEdge2d>& edges, const MakeLoss& make_loss,
               std::vector<Eigen::Vector3d>& poses, ceres::Problem& problem) {
  for (const PoseEdge2d& edge : edges) {
    const Eigen::Matrix3d root = edge.information.llt().matrixU();
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeResidual, 3, 3, 3>(
                                 new EdgeResidual{edge.T_from_to, root}),
                             make_loss ? make_loss() : nullptr, poses[edge.from].data(),
                             poses[edge.to].data());
  }
}

Poses solve_ceres(const Graph& graph, const MakeLoss& make_loss) {
  std::vector<Eigen::Vector3d> poses;
  for (const SE2& pose : graph.start) {
    poses.emplace_back(pose.x, pose.y, pose.yaw);
  }
  ceres::Problem problem;
  add_edges(graph.steps, {}, poses, problem);
  add_edges(graph.loops, make_loss, poses, problem);
  problem.SetParameterBlockConstant(poses.front().data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 200;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Poses result;
  for (const Eigen::Vector3d& pose : poses) {
    result.push_back({pose.x(), pose.y(), geometry::normalize_angle(pose.z())});
  }
  return result;
}

// Only the loops of the largest set that agree in pairs (Mangelson et al. 2018), without a kernel.
Poses solve_clique(const Graph& graph) {
  Graph kept = graph;
  kept.loops = bench::largest_clique(graph.steps, graph.loops, kInlierChiSquared);
  return solve_ceres(kept, {});
}

struct Method {
  const char* name;
  std::function<Poses(const Graph&)> solve;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {
      {"ours: graduated Geman-McClure kernel", solve_ours},
      {"Ceres, least squares", [](const Graph& graph) { return solve_ceres(graph, {}); }},
      {"Ceres, Huber kernel",
       [](const Graph& graph) {
         return solve_ceres(graph,
                            [] { return new ceres::HuberLoss(std::sqrt(kInlierChiSquared)); });
       }},
      {"Ceres, Cauchy kernel",
       [](const Graph& graph) {
         return solve_ceres(graph,
                            [] { return new ceres::CauchyLoss(std::sqrt(kInlierChiSquared)); });
       }},
      {"Ceres, dynamic covariance scaling",
       [](const Graph& graph) { return solve_ceres(graph, [] { return new DynamicScaling; }); }},
      {"largest clique of consistent loops, Ceres", solve_clique},
  };
  return all;
}

// How far the positions of some poses are from others, RMS and worst, m.
std::pair<double, double> distances_m(const Poses& poses, const Poses& others) {
  double sum = 0.0;
  double worst = 0.0;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double distance = geometry::distance_m(poses[k], others[k]);
    sum += distance * distance;
    worst = std::max(worst, distance);
  }
  return {std::sqrt(sum / static_cast<double>(poses.size())), worst};
}

// Prints a row for each solver: its times, and how far the wrong loops move its own result.
void measure(const std::string& folder) {
  const Graph graph = graph_of(slam2d::read_saved_map(folder));
  std::mt19937 random(1);
  const Graph damaged = with_wrong_loops(graph, random);
  std::printf("\n%s: %zu keyframes, %zu loops, %zu wrong ones\n\n", folder.c_str(),
              graph.start.size(), graph.loops.size(), damaged.loops.size() - graph.loops.size());
  std::printf(
      "| solver | right loops | with wrong ones | moved by them, RMS and worst |\n"
      "|---|---|---|---|\n");
  for (const Method& method : methods()) {
    const double start_ms = bench::process_cpu_ms();
    const Poses poses = method.solve(graph);
    const double between_ms = bench::process_cpu_ms();
    const auto [rms, worst] = distances_m(method.solve(damaged), poses);
    std::printf("| %s | %.0f ms | %.0f ms | %.3f, %.3f m |\n", method.name, between_ms - start_ms,
                bench::process_cpu_ms() - between_ms, rms, worst);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("compares solvers of 2D pose graphs");
  std::vector<std::string> folders;
  app.add_option("MAP", folders, "folders of saved maps")->required();
  CLI11_PARSE(app, argc, argv);
  std::printf(
      "| graph | solver | CPU time | distance from the reference, RMS and worst |\n"
      "|---|---|---|---|\n");
  try {
    std::for_each(folders.begin(), folders.end(), measure);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
