// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/serial_link.hpp"

#include <array>
#include <thread>
#include <utility>

#include "common/node/log.hpp"

namespace nodmap::serial {

SerialLink::SerialLink(std::string name, Opener open, Handlers handlers)
    : name_(std::move(name)), open_(std::move(open)), handlers_(std::move(handlers)) {}

void SerialLink::poll(const time::Moment& now) {
  if (!is_open()) {
    open(now);
    return;
  }
  std::array<std::uint8_t, 4096> buffer{};
  const ReadResult result = stream_->read(buffer, 0us);
  if (result.status == IoStatus::kDisconnected) {
    give_up(now, "the line is disconnected");
  } else if (result.count > 0) {
    handlers_.received(std::span(buffer).first(result.count), now);
  }
}

void SerialLink::open(const time::Moment& now) {
  if (ended_ || !back_off_.due(now.steady)) {
    return;
  }
  OpenResult result = open_();
  if (result.stream == nullptr) {
    if (result.error != error_) {
      log::get().warn("{}: {}", name_, result.error);
    }
    error_ = std::move(result.error);
    back_off_.failed(now.steady);
    return;
  }
  stream_ = std::move(result.stream);
  error_.clear();
  ++opened_;
  opened_at_ = now.steady;
  log::get().info("{}: the line is open", name_);
  handlers_.opened(now);
}

bool SerialLink::write(std::span<const std::uint8_t> bytes, const time::Moment& now,
                       const WriteOptions& options) {
  if (!is_open()) {
    return false;
  }
  const IoStatus status = write_all(bytes, options);
  if (status != IoStatus::kOk) {
    give_up(now, status == IoStatus::kTimeout ? "the line does not accept bytes"
                                              : "the line is disconnected");
  }
  return status == IoStatus::kOk;
}

IoStatus SerialLink::write_all(std::span<const std::uint8_t> bytes, const WriteOptions& options) {
  if (options.byte_pause == 0us) {
    return stream_->write(bytes, options.timeout);
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const IoStatus status = stream_->write(bytes.subspan(i, 1), options.timeout);
    if (status != IoStatus::kOk) {
      return status;
    }
    std::this_thread::sleep_for(options.byte_pause);
  }
  return IoStatus::kOk;
}

void SerialLink::set_baud(int baud) {
  if (!is_open()) {
    return;
  }
  if (!stream_->set_baud(baud)) {
    log::get().warn("{}: the line does not support {} bit/s", name_, baud);
  }
  stream_->discard_input();
}

void SerialLink::give_up(const time::Moment& now, const std::string& reason) {
  if (!is_open()) {
    return;
  }
  log::get().warn("{}: {}", name_, reason);
  // The pauses must also grow for a device that opens and fails at once, again and again.
  if (now.steady - opened_at_ >= BackOff::kLongest) {
    back_off_.succeeded();
  }
  back_off_.failed(now.steady);
  close(reason);
}

void SerialLink::end() {
  ended_ = true;
  if (is_open()) {
    close("closed");
  }
}

void SerialLink::close(const std::string& reason) {
  stream_.reset();
  error_ = reason;
  handlers_.lost();
}

SerialLink::Opener port_opener(const std::string& device, int baud) {
  return [device, baud] { return open_serial_port({device, baud}); };
}

}  // namespace nodmap::serial
