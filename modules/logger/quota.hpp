// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "modules/logger/rotation.hpp"

namespace nodmap::logger {

struct SizedFile {
  std::string name;
  std::int64_t size_bytes = 0;
};

/// Which of the files in a folder to delete, oldest first, so that those of the family keep
/// together within `quota_bytes`. Files of other names are neither counted nor deleted, and
/// `current`, which is being written, is counted but never deleted.
[[nodiscard]] std::vector<std::string> files_over_quota(const LogNames& names,
                                                        const std::vector<SizedFile>& files,
                                                        std::string_view current,
                                                        std::int64_t quota_bytes);

}  // namespace nodmap::logger
