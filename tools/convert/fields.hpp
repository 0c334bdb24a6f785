// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::convert {

/// Reads the words of a line one by one. Like a stream it remembers a failure: all later values are
/// zero, and ok() is false at the end.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) {}

  /// The next word; empty, and failed, at the end.
  std::string_view word();
  /// The next word as a number; infinity and NaN are permitted.
  double number();
  /// The next word as a finite number.
  double finite();
  /// The next word as a whole number >= 0.
  std::size_t count();
  /// The next word as a stamp in seconds, exact to the microsecond.
  time::Timestamp stamp();
  /// The next `count` numbers.
  std::vector<float> numbers(std::size_t count);

  [[nodiscard]] bool ok() const { return ok_; }
  /// Whether no word is left.
  [[nodiscard]] bool at_end() const;

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace nodmap::convert
