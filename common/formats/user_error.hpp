// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace nodmap::formats {

/// Thrown when what the user has given is wrong: the command line, a configuration, an environment
/// variable, or a file that it names. what() says where, and what is allowed. Programs print it and
/// end with exit code 2.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace nodmap::formats
