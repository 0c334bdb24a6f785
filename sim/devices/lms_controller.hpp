// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "sim/devices/lms_telegram.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

enum class LmsMode : std::uint8_t {
  kInstallation = 0x00,
  kDiagnosis = 0x10,
  kStream = 0x24,
  kOnRequest = 0x25,
  kStreamPartial = 0x2A,
};

struct LmsVariant {
  int field_deg = 180;
  int resolution_cdeg = 100;

  /// Mirror revolutions per scan.
  [[nodiscard]] int revolutions() const { return 100 / resolution_cdeg; }
};

/// The reaction to a request.
struct LmsAnswer {
  Bytes body;               ///< reply code and data; empty if the answer is a scan
  time::Duration delay{};   ///< from the request to the answer
  std::optional<int> baud;  ///< the rate after the answer
  bool restart = false;     ///< whether the sensor restarts after the answer
};

/// State of the sensor (mode, variant, configuration) and its answers to requests.
class LmsController {
 public:
  /// `config`: the 34 bytes in its memory. `baud`: the rate after power-on; a value other than 9600
  /// was made permanent.
  LmsController(Bytes config, int baud);

  [[nodiscard]] LmsAnswer answer(ByteView request);

  /// Resets to the state after power-on and returns the greeting.
  [[nodiscard]] Bytes start();

  [[nodiscard]] LmsMode mode() const { return mode_; }
  [[nodiscard]] const LmsVariant& variant() const { return variant_; }
  [[nodiscard]] LmsFormat format() const;
  [[nodiscard]] bool sends_indices() const;
  [[nodiscard]] int power_on_baud() const { return baud_is_permanent_ ? baud_ : 9600; }

  /// Whether a single scan was requested and not yet sent.
  [[nodiscard]] bool is_scan_requested() const { return is_scan_requested_; }
  [[nodiscard]] bool is_partial_scan_requested() const { return is_partial_scan_requested_; }
  void scan_sent() { is_scan_requested_ = is_partial_scan_requested_ = false; }

 private:
  [[nodiscard]] LmsAnswer set_mode(ByteView parameters);
  [[nodiscard]] LmsAnswer set_baud(int baud);
  [[nodiscard]] LmsAnswer set_variant(ByteView parameters);
  [[nodiscard]] LmsAnswer set_baud_permanent(ByteView parameters);
  [[nodiscard]] LmsAnswer request_scan(ByteView parameters);
  [[nodiscard]] LmsAnswer write_config(ByteView parameters);
  [[nodiscard]] Bytes status() const;

  LmsMode mode_ = LmsMode::kOnRequest;
  LmsVariant variant_;
  Bytes config_;
  int baud_;
  bool baud_is_permanent_;
  bool is_scan_requested_ = false;
  bool is_partial_scan_requested_ = false;
};

}  // namespace nodmap::sim
