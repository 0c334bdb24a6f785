// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/channel_filter.hpp"

#include "common/node/program.hpp"

namespace nodmap::logger {
namespace {

// More than a robot has channels; limits the memory used by meaningless names.
constexpr std::size_t kMaxDecided = 1000;

std::regex compile(const std::string& expression) {
  try {
    return std::regex(expression, std::regex::ECMAScript | std::regex::optimize);
  } catch (const std::regex_error& error) {
    throw node::UsageError("'" + expression + "' is not a regular expression: " + error.what());
  }
}

}  // namespace

ChannelFilter::ChannelFilter(const std::string& include, const std::string& exclude)
    : include_(compile(include)) {
  if (!exclude.empty()) {
    exclude_ = compile(exclude);
  }
}

bool ChannelFilter::wants(const std::string& channel) {
  const auto found = decided_.find(channel);
  if (found != decided_.end()) {
    return found->second;
  }
  if (decided_.size() >= kMaxDecided) {
    decided_.clear();
  }
  return decided_[channel] = decide(channel);
}

bool ChannelFilter::decide(const std::string& channel) const {
  return std::regex_match(channel, include_) && !(exclude_ && std::regex_match(channel, *exclude_));
}

}  // namespace nodmap::logger
