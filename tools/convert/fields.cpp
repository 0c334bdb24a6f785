// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/fields.hpp"

#include <algorithm>
#include <cmath>

#include "common/formats/number.hpp"
#include "common/formats/stamp.hpp"

namespace nodmap::convert {
namespace {

constexpr std::string_view kBlanks = " \t\r";

}  // namespace

std::string_view Fields::word() {
  const std::size_t first = std::min(rest_.find_first_not_of(kBlanks), rest_.size());
  const std::size_t last = std::min(rest_.find_first_of(kBlanks, first), rest_.size());
  const std::string_view found = rest_.substr(first, last - first);
  rest_.remove_prefix(last);
  ok_ = ok_ && !found.empty();
  return found;
}

double Fields::number() {
  const auto value = formats::parse_number<double>(word());
  ok_ = ok_ && value.has_value();
  return ok_ ? *value : 0.0;
}

double Fields::finite() {
  const double value = number();
  ok_ = ok_ && std::isfinite(value);
  return ok_ ? value : 0.0;
}

std::size_t Fields::count() {
  const auto value = formats::parse_number<std::size_t>(word());
  ok_ = ok_ && value.has_value();
  return ok_ ? *value : 0;
}

time::Timestamp Fields::stamp() {
  const auto stamp = formats::parse_stamp(word());
  ok_ = ok_ && stamp.has_value();
  return ok_ ? *stamp : time::Timestamp{};
}

std::vector<float> Fields::numbers(std::size_t count) {
  std::vector<float> values;
  // A damaged count must not allocate memory; each number takes at least two characters.
  values.reserve(std::min(count, rest_.size() / 2 + 1));
  for (std::size_t i = 0; i < count && ok_; ++i) {
    const auto value = formats::parse_number<float>(word());
    ok_ = ok_ && value.has_value();
    values.push_back(value.value_or(0.0F));
  }
  return values;
}

bool Fields::at_end() const {
  return rest_.find_first_not_of(kBlanks) == std::string_view::npos;
}

}  // namespace nodmap::convert
