// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d::test {

/// A minimal sensor, written after the manual: it recognises requests as bytes and does not use the
/// driver's encoders.
class FakeSensor {
 public:
  int baud = 9600;
  bool powered = true;
  bool streaming = false;
  bool frozen = false;
  bool blind = false;       // no echoes
  bool too_weak = false;    // echoes are too weak to be measured
  bool covered = false;     // its window: every reading is less than 5 cm
  int num_echoes = 1000;    // at most; no echoes of the beams after these
  bool interlaced = false;  // shifted by a quarter of a degree with each scan
  bool deaf_to_variant = false;
  std::uint8_t status = 0x10;
  int ignore_next = 0;  // requests to swallow
  Bytes config = hex("00 00 70 00 02 06 01 00 00 02 02 00x21 02 00");
  int config_writes = 0;
  bool keeps_its_unit = false;  // whatever is written
  bool installing = false;
  std::size_t values = 181;

  Bytes answer(const Bytes& request, int line_baud) {
    if (!powered || line_baud != baud || request.size() < 7 || request[0] != 0x02) {
      return {};
    }
    if (ignore_next > 0) {
      --ignore_next;
      return {};
    }
    const Bytes body(request.begin() + 4, request.end() - 2);
    return hex("06") + reply_to(body);
  }

  Bytes next_scan() {
    ++scans_;
    const int quarter = interlaced ? scans_ % 4 : 0;  // different readings in each quarter
    const int first = 1000 + (frozen ? quarter : scans_ % 50);
    Bytes data = {0xB0};
    serial::append_little(data, header());
    const int echoes = std::min(num_echoes, static_cast<int>(values));
    const int none = static_cast<int>(values) - echoes;
    data = data + (blind      ? same(0x7FF7)
                   : too_weak ? same(0x7FFF)
                   : covered  ? same(static_cast<std::uint16_t>(scans_ % 50))
                              : ramp(echoes, first) + ramp(none, 0x7FF7, 0));
    data.push_back(static_cast<std::uint8_t>(scans_));  // a mirror revolution for each
    data.push_back(static_cast<std::uint8_t>(scans_));
    return sick_frame(data, status);
  }

 private:
  [[nodiscard]] std::uint16_t header() const {
    const unsigned partial = interlaced ? 0x2000U | static_cast<unsigned>(scans_ % 4) << 11U : 0U;
    return static_cast<std::uint16_t>(0x4000U | partial | values);
  }

  [[nodiscard]] Bytes same(std::uint16_t value) const {
    Bytes bytes;
    for (std::size_t i = 0; i < values; ++i) {
      serial::append_little(bytes, value);
    }
    return bytes;
  }

  Bytes reply_to(const Bytes& body) {
    switch (body[0]) {
      case 0x20:
        return mode_reply(body);
      case 0x3B:
        if (deaf_to_variant) {
          return kVariantRefused;
        }
        values = body[1] * 100U / body[3] + 1;
        return sick_frame(hex("BB 01") + Bytes(body.begin() + 1, body.end()));
      case 0x74:
        return sick_frame(hex("F4") + config);
      case 0x77:
        if (!installing) {
          return kNotAccepted;
        }
        ++config_writes;
        config.assign(body.begin() + 1, body.end());
        if (keeps_its_unit) {
          config[6] = 0x00;
        }
        return sick_frame(hex("F7 01") + config);
      default:
        return kNotAccepted;
    }
  }

  Bytes mode_reply(const Bytes& body) {
    switch (body[1]) {
      case 0x00:
        installing = true;
        break;
      case 0x25:
        streaming = installing = false;
        break;
      case 0x24:
      case 0x2A:
        streaming = true;
        break;
      case 0x48:
        baud = 500000;
        break;
      case 0x42:
        baud = 9600;
        break;
      default:
        return kNotAccepted;
    }
    return kModeOk;
  }

  int scans_ = 0;
};

}  // namespace nodmap::laser3d::test
