// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <regex>
#include <string>

namespace nodmap::logger {

/// Selects the channels to record. Regular expressions (ECMAScript) must match the whole name, as
/// in LCM.
class ChannelFilter {
 public:
  /// An empty `exclude` excludes nothing. Throws node::UsageError, naming the expression, for an
  /// invalid one.
  ChannelFilter(const std::string& include, const std::string& exclude);

  [[nodiscard]] bool wants(const std::string& channel);
  /// The number of channels whose answer is remembered.
  [[nodiscard]] std::size_t num_remembered() const { return decided_.size(); }

 private:
  [[nodiscard]] bool decide(const std::string& channel) const;

  std::regex include_;
  std::optional<std::regex> exclude_;
  std::map<std::string, bool> decided_;  // cache: matching takes microseconds
};

}  // namespace nodmap::logger
