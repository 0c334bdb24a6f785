// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace nodmap::viewer {

/// The answer to a request, as text for people.
struct Answer {
  bool ok = false;
  std::string text;
};

}  // namespace nodmap::viewer
