// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/text_lines.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/formats/input_file.hpp"

namespace nodmap::formats {
namespace {

constexpr std::size_t kMaxLineBytes = 1'000'000;  // lines of the recordings have some kilobytes

}  // namespace

TextLines::TextLines(const std::filesystem::path& file)
    : file_(file), in_(open_input(file)), buffer_(kMaxLineBytes + 1) {}

bool TextLines::next() {
  in_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  if (in_.bad()) {
    throw std::runtime_error(file_.string() + ": cannot read");
  }
  if (in_.fail() && in_.eof()) {
    return false;
  }
  ++number_;
  if (in_.fail()) {
    throw InputFileError(place() + ": a line of more than a megabyte; this is not a text file");
  }
  const auto taken = static_cast<std::size_t>(in_.gcount());  // with the end of the line, if any
  line_ = {buffer_.data(), in_.eof() ? taken : taken - 1};
  return true;
}

bool TextLines::next_content() {
  while (next()) {
    const std::size_t first = line_.find_first_not_of(" \t\r");
    if (first != std::string_view::npos && line_[first] != '#') {
      return true;
    }
  }
  return false;
}

std::string TextLines::place() const {
  return file_.string() + ":" + std::to_string(number_);
}

std::string printable(std::string_view text) {
  std::string shown(text);
  std::ranges::replace_if(
      shown, [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

std::string quote(std::string_view text) {
  constexpr std::size_t kMaxQuoted = 80;
  std::string quoted = "'";
  quoted += printable(text.substr(0, kMaxQuoted));
  quoted += text.size() > kMaxQuoted ? "...'" : "'";
  return quoted;
}

}  // namespace nodmap::formats
