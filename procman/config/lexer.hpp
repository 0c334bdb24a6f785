// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// What is wrong with a configuration, and where.
class SyntaxError : public std::runtime_error {
 public:
  SyntaxError(Place place, const std::string& what) : std::runtime_error(what), place_(place) {}
  [[nodiscard]] Place place() const { return place_; }

 private:
  Place place_;
};

enum class TokenKind : std::uint8_t {
  kIdentifier,
  kString,
  kInteger,
  kAssign,
  kSemicolon,
  kOpen,
  kClose,
  kEnd
};

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string text;  ///< of a string without quotes and escapes
  Place place;
  bool is_extension = false;  ///< stands in a `#nodmap:` comment
};

/// Cuts the text of a configuration into tokens. Comments go from `#` to the end of the line, but
/// for those that begin with `#nodmap:`, whose words are tokens marked as ours.
class Lexer {
 public:
  /// `text` must outlive the lexer.
  explicit Lexer(std::string_view text) : text_(text) {}

  /// The next token; kEnd again and again after the last. Throws SyntaxError.
  [[nodiscard]] Token next();

 private:
  [[nodiscard]] bool at_end() const { return at_ == text_.size(); }
  [[nodiscard]] char peek() const { return text_[at_]; }
  char take();
  void skip_blanks_and_comments();
  void begin_comment();
  [[nodiscard]] std::string take_string(Place begin);
  template <class Predicate>
  [[nodiscard]] std::string take_while(Predicate belongs);

  std::string_view text_;
  std::size_t at_ = 0;
  Place place_;
  bool in_extension_ = false;
};

}  // namespace nodmap::procman
