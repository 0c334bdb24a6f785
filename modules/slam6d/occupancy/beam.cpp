// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/beam.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace nodmap::slam6d {
namespace {

std::uint32_t count_steps(const VoxelKey& from, const VoxelKey& to) {
  std::uint32_t steps = 0;
  for (std::size_t axis = 0; axis < from.size(); ++axis) {
    steps += static_cast<std::uint32_t>(std::abs(int{to[axis]} - int{from[axis]}));
  }
  return steps;
}

std::size_t axis_of_nearest_border(const Beam& beam) {
  const auto& [x, y, z] = beam.next_border_m;
  if (x < y) {
    return x < z ? 0 : 2;
  }
  return y < z ? 1 : 2;
}

void enter_next_voxel(Beam& beam) {
  const std::size_t axis = axis_of_nearest_border(beam);
  beam.next_border_m[axis] += beam.between_borders_m[axis];
  // An addition in the bits of one axis: the bits between them are set, so that they pass the carry
  // on.
  const VoxelCode others = ~kAxisBits[axis];
  const VoxelCode sum = (beam.voxel | others) + beam.steps[axis];
  beam.voxel = (sum & ~others) | (beam.voxel & others);
}

bool is_at_end(const Beam& beam) {
  // Rounding may lead past the end voxel; then the distance ends the walk.
  return beam.voxel == beam.end_voxel || std::ranges::min(beam.next_border_m) > beam.length_m;
}

#if defined(__x86_64__)

// The functions above for four beams, one in each lane. Always inlined, because such vectors cannot
// be passed in registers without AVX2.
#define NODMAP_AVX2 [[gnu::target("avx2"), gnu::always_inline]] inline

struct FourBeams {
  __m256d next_x, next_y, next_z;
  __m256d between_x, between_y, between_z;
  __m256d length;
  __m256i voxel, end_voxel;
  __m256i step_x, step_y, step_z;
};

NODMAP_AVX2 __m256d lanes(double a, double b, double c, double d) {
  return _mm256_set_pd(d, c, b, a);
}

NODMAP_AVX2 __m256i lanes(VoxelCode a, VoxelCode b, VoxelCode c, VoxelCode d) {
  return _mm256_set_epi64x(std::bit_cast<std::int64_t>(d), std::bit_cast<std::int64_t>(c),
                           std::bit_cast<std::int64_t>(b), std::bit_cast<std::int64_t>(a));
}

// `value_of` of each beam.
template <typename ValueOf>
NODMAP_AVX2 auto lanes(std::span<const Beam, 4> beams, ValueOf value_of) {
  return lanes(value_of(beams[0]), value_of(beams[1]), value_of(beams[2]), value_of(beams[3]));
}

NODMAP_AVX2 FourBeams load(std::span<const Beam, 4> beams) {
  return {.next_x = lanes(beams, [](const Beam& beam) { return beam.next_border_m[0]; }),
          .next_y = lanes(beams, [](const Beam& beam) { return beam.next_border_m[1]; }),
          .next_z = lanes(beams, [](const Beam& beam) { return beam.next_border_m[2]; }),
          .between_x = lanes(beams, [](const Beam& beam) { return beam.between_borders_m[0]; }),
          .between_y = lanes(beams, [](const Beam& beam) { return beam.between_borders_m[1]; }),
          .between_z = lanes(beams, [](const Beam& beam) { return beam.between_borders_m[2]; }),
          .length = lanes(beams, [](const Beam& beam) { return beam.length_m; }),
          .voxel = lanes(beams, [](const Beam& beam) { return beam.voxel; }),
          .end_voxel = lanes(beams, [](const Beam& beam) { return beam.end_voxel; }),
          .step_x = lanes(beams, [](const Beam& beam) { return beam.steps[0]; }),
          .step_y = lanes(beams, [](const Beam& beam) { return beam.steps[1]; }),
          .step_z = lanes(beams, [](const Beam& beam) { return beam.steps[2]; })};
}

// For each lane the value of its axis: x, y or neither.
NODMAP_AVX2 __m256i select(__m256d is_x, __m256d is_y, __m256i x, __m256i y, __m256i z) {
  const __m256d y_or_z = _mm256_blendv_pd(_mm256_castsi256_pd(z), _mm256_castsi256_pd(y), is_y);
  return _mm256_castpd_si256(_mm256_blendv_pd(y_or_z, _mm256_castsi256_pd(x), is_x));
}

NODMAP_AVX2 __m256i others_of(std::size_t axis) {
  return _mm256_set1_epi64x(std::bit_cast<std::int64_t>(~kAxisBits[axis]));
}

NODMAP_AVX2 void enter_next_voxels(FourBeams& b) {
  const __m256d x_before_y = _mm256_cmp_pd(b.next_x, b.next_y, _CMP_LT_OQ);
  const __m256d is_x = _mm256_and_pd(x_before_y, _mm256_cmp_pd(b.next_x, b.next_z, _CMP_LT_OQ));
  const __m256d is_y = _mm256_andnot_pd(x_before_y, _mm256_cmp_pd(b.next_y, b.next_z, _CMP_LT_OQ));
  const __m256d is_not_z = _mm256_or_pd(is_x, is_y);
  b.next_x += _mm256_and_pd(is_x, b.between_x);
  b.next_y += _mm256_and_pd(is_y, b.between_y);
  b.next_z += _mm256_andnot_pd(is_not_z, b.between_z);

  const __m256i others = select(is_x, is_y, others_of(0), others_of(1), others_of(2));
  const __m256i step = select(is_x, is_y, b.step_x, b.step_y, b.step_z);
  const __m256i sum = _mm256_or_si256(b.voxel, others) + step;
  b.voxel = _mm256_or_si256(_mm256_andnot_si256(others, sum), _mm256_and_si256(b.voxel, others));
}

// A bit for each beam.
NODMAP_AVX2 unsigned are_at_end(const FourBeams& b) {
  const __m256d is_beyond =
      _mm256_and_pd(_mm256_and_pd(_mm256_cmp_pd(b.next_x, b.length, _CMP_GT_OQ),
                                  _mm256_cmp_pd(b.next_y, b.length, _CMP_GT_OQ)),
                    _mm256_cmp_pd(b.next_z, b.length, _CMP_GT_OQ));
  const __m256i is_end = _mm256_cmpeq_epi64(b.voxel, b.end_voxel);
  return static_cast<unsigned>(
      _mm256_movemask_pd(_mm256_or_pd(_mm256_castsi256_pd(is_end), is_beyond)));
}

NODMAP_AVX2 std::array<VoxelCode, 4> voxels_of(const FourBeams& b) {
  alignas(__m256i) std::array<VoxelCode, 4> codes{};
  _mm256_store_si256(reinterpret_cast<__m256i*>(codes.data()), b.voxel);
  return codes;
}

// The number of steps at the end of a beam that must check whether it ends. A walk ends at a
// border beyond the beam's end. num_steps borders lie before it; by rounding, the last one on each
// axis may seem to lie beyond it. So these are at most three, and no walk ends before it has
// crossed the others.
constexpr std::uint32_t kLastSteps = 4;

[[gnu::target("avx2")]] void walk_four(std::span<const Beam, 4> beams, CloudVoxels& voxels) {
  FourBeams four = load(beams);
  for (const VoxelCode voxel : voxels_of(four)) {
    voxels.mark_free(voxel);
  }
  const std::uint32_t num_steps =
      std::min({beams[0].num_steps, beams[1].num_steps, beams[2].num_steps, beams[3].num_steps});
  for (std::uint32_t step = kLastSteps; step < num_steps; ++step) {
    enter_next_voxels(four);
    for (const VoxelCode voxel : voxels_of(four)) {
      voxels.mark_free(voxel);
    }
  }
  unsigned ended = 0;
  for (;;) {
    enter_next_voxels(four);
    ended |= are_at_end(four);
    if (ended == 0xFU) {
      return;
    }
    const std::array<VoxelCode, 4> codes = voxels_of(four);
    for (std::size_t lane = 0; lane < codes.size(); ++lane) {
      if ((ended >> lane & 1U) == 0U) {
        voxels.mark_free(codes[lane]);
      }
    }
  }
}

#undef NODMAP_AVX2
#endif

}  // namespace

Beam make_beam(const OctreeGrid& grid, const Eigen::Vector3f& p_origin, const VoxelKey& origin,
               const Eigen::Vector3f& p_end, const VoxelKey& end) {
  constexpr double kNever = std::numeric_limits<double>::max();
  const Eigen::Vector3f to_end = p_end - p_origin;
  const auto length_m = static_cast<float>(length_of(to_end));
  const auto half_voxel_m = static_cast<double>(static_cast<float>(0.5 * grid.resolution_m()));
  Beam beam;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const float direction = to_end[i] / length_m;
    const bool is_forward = direction > 0.0F;
    if (!is_forward && !(direction < 0.0F)) {
      beam.next_border_m[axis] = kNever;
      beam.between_borders_m[axis] = kNever;
      continue;
    }
    const double border_m =
        grid.center_m(origin[axis]) + (is_forward ? half_voxel_m : -half_voxel_m);
    beam.next_border_m[axis] =
        (border_m - static_cast<double>(p_origin[i])) / static_cast<double>(direction);
    beam.between_borders_m[axis] = grid.resolution_m() / static_cast<double>(std::abs(direction));
    beam.steps[axis] = is_forward ? VoxelCode{1} << axis : kAxisBits[axis];
  }
  // If the ends are so near that the square of their distance is zero, there is only the voxel of
  // the origin.
  beam.length_m = length_m > 0.0F ? static_cast<double>(length_m) : -1.0;
  beam.voxel = code_of(origin);
  beam.end_voxel = code_of(end);
  beam.num_steps = count_steps(origin, end);
  return beam;
}

void walk(Beam beam, CloudVoxels& voxels) {
  do {
    voxels.mark_free(beam.voxel);
    enter_next_voxel(beam);
  } while (!is_at_end(beam));
}

void walk(std::span<const Beam> beams, CloudVoxels& voxels) {
#if defined(__x86_64__)
  if (static_cast<bool>(__builtin_cpu_supports("avx2"))) {
    for (; beams.size() >= 4; beams = beams.subspan(4)) {
      walk_four(beams.first<4>(), voxels);
    }
  }
#endif
  for (const Beam& beam : beams) {
    walk(beam, voxels);
  }
}

}  // namespace nodmap::slam6d
