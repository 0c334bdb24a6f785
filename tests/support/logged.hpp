// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>

namespace nodmap::test {

/// What `act` logs; each message is a line "LEVEL: TEXT".
template <class Act>
[[nodiscard]] std::string logged(const Act& act) {
  std::ostringstream text;
  const auto before = spdlog::default_logger();
  const auto logger = std::make_shared<spdlog::logger>(
      "logged", std::make_shared<spdlog::sinks::ostream_sink_st>(text));
  logger->set_pattern("%l: %v");
  spdlog::set_default_logger(logger);
  act();
  spdlog::set_default_logger(before);
  return text.str();
}

}  // namespace nodmap::test
