// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/wire_layout.hpp"

#include <array>
#include <optional>

namespace nodmap::bus {
namespace {

// More count fields than any struct of ours has; messages of a struct with more are refused.
constexpr std::size_t kMaxCounts = 16;

// The bytes that are left to read. No call reads beyond the end; it fails instead.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool skip(std::uint64_t size) {
    if (size > rest_.size()) {
      return false;
    }
    rest_ = rest_.subspan(static_cast<std::size_t>(size));
    return true;
  }

  [[nodiscard]] std::optional<std::int64_t> take_integer(std::uint32_t size) {
    if (size == 0 || size > 8 || size > rest_.size()) {
      return std::nullopt;
    }
    // Big endian; the first byte carries the sign.
    auto value =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(static_cast<std::int8_t>(rest_[0])));
    for (std::uint32_t i = 1; i < size; ++i) {
      value = (value << 8U) | static_cast<std::uint64_t>(rest_[i]);
    }
    rest_ = rest_.subspan(size);
    return static_cast<std::int64_t>(value);
  }

  [[nodiscard]] bool skip_string() {
    const std::optional<std::int64_t> length = take_integer(4);  // counts the closing zero
    if (!length || *length < 1 || static_cast<std::uint64_t>(*length) > rest_.size() ||
        rest_[static_cast<std::size_t>(*length) - 1] != std::byte{0}) {
      return false;
    }
    return skip(static_cast<std::uint64_t>(*length));
  }

  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
};

using Counts = std::array<std::uint64_t, kMaxCounts>;

// The number of elements of a member; empty if they cannot fit. An element takes at least one
// byte, so a count greater than the number of bytes left is wrong (this also keeps products
// small).
std::optional<std::uint64_t> element_count(const WireField& field, const Counts& counts,
                                           std::size_t bytes_left) {
  std::uint64_t count = field.fixed_count;
  for (const std::int32_t slot : field.count_slots) {
    if (slot >= 0) {
      count *= counts[static_cast<std::size_t>(slot)];
      if (count > bytes_left) {
        return std::nullopt;
      }
    }
  }
  return count;
}

bool walk(std::span<const WireField> fields, Reader& reader);

bool walk_elements(const WireField& field, std::uint64_t count, Reader& reader) {
  if (field.form == WireForm::kPlain) {
    return reader.skip(count * field.size_bytes);
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    if (field.form == WireForm::kString ? !reader.skip_string() : !walk(field.nested, reader)) {
      return false;
    }
  }
  return true;
}

bool walk(std::span<const WireField> fields, Reader& reader) {
  Counts counts{};
  for (const WireField& field : fields) {
    if (field.stores_count >= 0) {
      const std::optional<std::int64_t> value = reader.take_integer(field.size_bytes);
      if (!value || *value < 0 || static_cast<std::size_t>(field.stores_count) >= kMaxCounts) {
        return false;
      }
      // A count greater than the number of bytes left is wrong. Refusing it here keeps products
      // small.
      if (static_cast<std::uint64_t>(*value) > reader.left()) {
        return false;
      }
      counts[static_cast<std::size_t>(field.stores_count)] = static_cast<std::uint64_t>(*value);
      continue;
    }
    const std::optional<std::uint64_t> count = element_count(field, counts, reader.left());
    if (!count || !walk_elements(field, *count, reader)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool fits_layout(std::span<const WireField> fields, std::span<const std::byte> bytes) {
  Reader reader(bytes);
  return walk(fields, reader) && reader.left() == 0;
}

}  // namespace nodmap::bus
