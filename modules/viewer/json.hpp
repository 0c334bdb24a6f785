// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "modules/viewer/foxglove/foxglove.hpp"

namespace nodmap::viewer {

/// The text of this name in a client's message; empty where there is none.
inline std::string text_in(const foxglove::Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace nodmap::viewer
