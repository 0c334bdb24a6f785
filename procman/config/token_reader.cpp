// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/token_reader.hpp"

#include <algorithm>
#include <charconv>

namespace nodmap::procman {

std::string TokenReader::found() const {
  return at_end() ? "the end of the file" : "'" + token_.text + "'";
}

std::string TokenReader::expect(TokenKind kind, const char* what) {
  if (token_.kind != kind || token_.is_extension != is_extension_expected_) {
    fail(std::string("expected ") + what + ", found " + found());
  }
  std::string text = token_.text;
  advance();
  return text;
}

std::string TokenReader::expect_word(std::initializer_list<const char*> words) {
  const bool fits = token_.kind == TokenKind::kIdentifier &&
                    std::find(words.begin(), words.end(), token_.text) != words.end();
  if (!fits) {
    std::string list;
    for (const char* word : words) {
      list += list.empty() ? "" : ", ";
      list += word;
    }
    fail("expected " + list + ", found " + found());
  }
  return expect(TokenKind::kIdentifier, "a word");
}

int TokenReader::expect_integer(int min, int max) {
  const Place place = token_.place;
  const std::string text = expect(TokenKind::kInteger, "an integer");
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < min || value > max) {
    throw SyntaxError(
        place, text + " is not within " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

}  // namespace nodmap::procman
