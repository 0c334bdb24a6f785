// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>

#include <stdexcept>

namespace nodmap::log {

void start(const std::string& process_name, const std::string& level) {
  const spdlog::level::level_enum parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off && level != "off") {
    throw std::invalid_argument("--log-level: '" + level +
                                "' is not one of trace, debug, info, warn, error, off");
  }
  spdlog::drop(process_name);
  auto logger = spdlog::stderr_color_mt(process_name);
  logger->set_level(parsed);
  logger->set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace nodmap::log
