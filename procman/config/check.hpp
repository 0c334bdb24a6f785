// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "procman/config/parser.hpp"

namespace nodmap::procman {

/// What the scripts of a configuration name that is not there, and scripts that run themselves.
[[nodiscard]] std::vector<ConfigError> check_scripts(const Config& config);

}  // namespace nodmap::procman
