// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Reads world `index` from a text file of the BARN challenge's worlds (Perille et al.,
/// Benchmarking Metric Ground Navigation, SSRR 2020), static or dynamic (DynaBARN: Nair et al.,
/// SSRR 2022):
///
///     W index n      then, static:  n lines "x y", upright cylinders of 0.075 m radius
///                    or, dynamic:   n times "C radius period_s k name" and k lines "t x y"
///
/// with the challenge's start, goal and rules. A file optimal.txt beside it contains the lengths of
/// the reference paths. Throws formats::UserError that names file and line.
[[nodiscard]] World load_barn_world(const std::filesystem::path& file, int index);

}  // namespace nodmap::sim
