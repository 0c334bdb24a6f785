// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <string>
#include <vector>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// Runs all deputies of a configuration on this host, as children of this process (--lone). They
/// and their commands end with this process, however it ends.
class LoneDeputies : boost::noncopyable {
 public:
  /// Starts nodmap-deputy from the folder of this program, once for each deputy in `config`. Throws
  /// std::system_error.
  LoneDeputies(const std::string& config_file, const Config& config, const std::string& lcm_url);
  ~LoneDeputies() { stop(); }

  /// Stops them and waits until all their commands have ended. Returns whether all ended without
  /// error.
  bool stop();

 private:
  std::vector<pid_t> deputies_;
};

}  // namespace nodmap::procman
