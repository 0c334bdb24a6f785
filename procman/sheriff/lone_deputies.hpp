// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <string>
#include <vector>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// All deputies of a configuration as children of this process, on this host, for --lone. They end
/// with it, however it ends, and with them whatever they run.
class LoneDeputies : boost::noncopyable {
 public:
  /// Starts the nodmap-deputy that lies beside this program, once for each deputy that
  /// `config` names. Throws std::system_error.
  LoneDeputies(const std::string& config_file, const Config& config, const std::string& lcm_url);
  ~LoneDeputies() { stop(); }

  /// Ends them, and waits until all that they run has ended. Whether each ended well.
  bool stop();

 private:
  std::vector<pid_t> deputies_;
};

}  // namespace nodmap::procman
