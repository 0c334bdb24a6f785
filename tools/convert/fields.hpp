// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::convert {

/// Reads the words of a line one after the other. Like a stream it remembers a failure: what comes
/// after one is zero, and ok() tells at the end.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) {}

  /// The next word; empty, and failed, at the end.
  std::string_view word();
  /// The next word if it is a number; infinity and NaN are numbers, too.
  double number();
  /// The next word if it is a number that is neither.
  double finite();
  /// The next word if it is a whole number >= 0.
  std::size_t count();
  /// The next word if it is a stamp in seconds, as exact microseconds.
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
