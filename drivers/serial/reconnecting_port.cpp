// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/reconnecting_port.hpp"

#include <utility>

namespace nodmap::serial {

ByteStream* ReconnectingPort::stream(std::int64_t now_us) {
  if (stream_ == nullptr && back_off_.due(now_us)) {
    OpenResult result = open_();
    stream_ = std::move(result.stream);
    error_ = std::move(result.error);
    if (stream_ != nullptr) {
      ++opened_;
      opened_us_ = now_us;
    } else {
      back_off_.failed(now_us);
    }
  }
  return stream_.get();
}

void ReconnectingPort::give_up(std::int64_t now_us, const std::string& reason) {
  if (stream_ == nullptr) {
    return;
  }
  stream_.reset();
  error_ = reason;
  // A device that opens and fails at once, again and again, must not escape the growing pauses.
  if (now_us - opened_us_ >= BackOff::kLongestUs) {
    back_off_.succeeded();
  }
  back_off_.failed(now_us);
}

}  // namespace nodmap::serial
