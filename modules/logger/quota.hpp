// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modules/logger/rotation.hpp"

namespace nodmap::logger {

struct SizedFile {
  std::string name;
  std::int64_t size_bytes = 0;
};

/// Selects the files of a folder to delete, oldest first, so that all files of the family `names`
/// together take at most `quota_bytes`. Files with other names are neither counted nor deleted;
/// `kept` are counted but never deleted.
[[nodiscard]] std::vector<std::string> files_over_quota(const LogNames& names,
                                                        const std::vector<SizedFile>& files,
                                                        const std::vector<std::string>& kept,
                                                        std::int64_t quota_bytes);

}  // namespace nodmap::logger
