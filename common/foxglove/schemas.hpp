// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace nodmap::foxglove {

/// The JSON Schema of what is sent under this name, foxglove.* or nodmap.*. Throws
/// std::out_of_range for another name.
[[nodiscard]] const std::string& schema_text(const std::string& schema_name);

}  // namespace nodmap::foxglove
