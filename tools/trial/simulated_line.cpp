// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/simulated_line.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace nodmap::trial {

using serial::IoStatus;
using std::chrono::microseconds;

// The driver's end. It never waits, because simulated time does not advance while a driver works.
class SimulatedLine::Stream final : public serial::ByteStream {
 public:
  explicit Stream(SimulatedLine& line) : line_(&line) { line.stream_ = this; }
  ~Stream() override {
    if (line_ != nullptr) {
      line_->stream_ = nullptr;
    }
  }

  void disconnect() { line_ = nullptr; }

  [[nodiscard]] serial::ReadResult read(std::span<std::uint8_t> buffer,
                                        microseconds /*timeout*/) override {
    if (line_ == nullptr) {
      return {IoStatus::kDisconnected, 0};
    }
    std::vector<std::uint8_t>& inbox = line_->inbox_;
    const std::size_t count = std::min(buffer.size(), inbox.size());
    if (count == 0) {
      return {IoStatus::kTimeout, 0};
    }
    const auto end = inbox.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(inbox.begin(), end, buffer.begin());
    inbox.erase(inbox.begin(), end);
    return {IoStatus::kOk, count};
  }

  [[nodiscard]] IoStatus write(std::span<const std::uint8_t> bytes,
                               microseconds /*timeout*/) override {
    if (line_ == nullptr) {
      return IoStatus::kDisconnected;
    }
    line_->device_.receive(bytes, line_->baud_, line_->now_);
    return IoStatus::kOk;
  }

  [[nodiscard]] bool set_baud(int baud) override {
    if (line_ != nullptr) {
      line_->baud_ = baud;
    }
    return line_ != nullptr;
  }

  void discard_input() override {
    if (line_ != nullptr) {
      line_->inbox_.clear();
    }
  }

  [[nodiscard]] bool connected() const override { return line_ != nullptr; }
  [[nodiscard]] int poll_handle() const override { return -1; }

 private:
  SimulatedLine* line_;
};

void SimulatedLine::move_bytes(time::SteadyTime now) {
  now_ = now;
  if (!device_.is_plugged_in(now)) {
    cut();
  }
  if (device_.next_due() > now) {
    return;
  }
  device_.transmit(now, baud_, inbox_);
  if (stream_ == nullptr) {
    inbox_.clear();  // no reader, so the bytes are lost
  }
}

serial::OpenResult SimulatedLine::open(int baud) {
  if (!device_.is_plugged_in(now_)) {
    return {nullptr, "no such device"};
  }
  if (stream_ != nullptr) {
    return {nullptr, "in use by another process"};
  }
  baud_ = baud;
  inbox_.clear();
  return {std::make_unique<Stream>(*this), ""};
}

void SimulatedLine::cut() {
  if (stream_ != nullptr) {
    std::exchange(stream_, nullptr)->disconnect();
  }
  inbox_.clear();
}

}  // namespace nodmap::trial
