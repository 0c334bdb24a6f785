// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/quota.hpp"

#include <algorithm>
#include <map>

namespace nodmap::logger {

std::vector<std::string> files_over_quota(const LogNames& names,
                                          const std::vector<SizedFile>& files,
                                          const std::vector<std::string>& kept,
                                          std::int64_t quota_bytes) {
  std::int64_t total_bytes = 0;
  std::map<LogOrder, const SizedFile*> oldest_first;
  for (const SizedFile& file : files) {
    const std::optional<LogOrder> order = names.order_of(file.name);
    if (!order) {
      continue;
    }
    total_bytes += file.size_bytes;
    if (std::ranges::find(kept, file.name) == kept.end()) {
      oldest_first.emplace(*order, &file);
    }
  }
  std::vector<std::string> over;
  for (const auto& [order, file] : oldest_first) {
    if (total_bytes <= quota_bytes) {
      break;
    }
    over.push_back(file->name);
    total_bytes -= file->size_bytes;
  }
  return over;
}

}  // namespace nodmap::logger
