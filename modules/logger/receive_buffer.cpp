// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/receive_buffer.hpp"

namespace nodmap::logger {

std::string with_receive_buffer(const std::string& url, std::int64_t size_bytes) {
  constexpr const char* kOption = "recv_buf_size=";
  if (size_bytes == 0 || !url.starts_with("udpm://") || url.find(kOption) != std::string::npos) {
    return url;
  }
  const char* separator = url.find('?') == std::string::npos ? "?" : "&";
  return url + separator + kOption + std::to_string(size_bytes);
}

}  // namespace nodmap::logger
