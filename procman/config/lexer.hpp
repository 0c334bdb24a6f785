// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// An error in a configuration, with its position.
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
  std::string text;  ///< of a string: without quotes, escapes resolved
  Place place;
  bool is_extension = false;  ///< whether it is in a `#nodmap:` comment
};

/// Splits the text of a configuration into tokens. Comments extend from `#` to the end of the line.
/// The words of a comment that begins with `#nodmap:` are tokens marked as extensions.
class Lexer {
 public:
  /// `text` must outlive the lexer.
  explicit Lexer(std::string_view text) : text_(text) {}

  /// The next token; kEnd after the last one. Throws SyntaxError.
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

/// Reads the tokens of a configuration one by one and checks each: a token of some kind, one of
/// several words, a number within limits. If the check fails, it throws a SyntaxError that says
/// what was expected, what was found, and where.
class TokenReader {
 public:
  /// `text` must outlive the reader.
  explicit TokenReader(std::string_view text) : lexer_(text) { advance(); }

  /// The next token, not yet taken.
  [[nodiscard]] const Token& token() const { return token_; }
  [[nodiscard]] bool at_end() const { return token_.kind == TokenKind::kEnd; }
  /// Whether a block ends here. A brace in a `#nodmap:` comment does not end one.
  [[nodiscard]] bool closes() const {
    return token_.kind == TokenKind::kClose && !token_.is_extension;
  }
  void advance() { token_ = lexer_.next(); }

  /// Sets whether the following tokens must, or must not, be in a `#nodmap:` comment. Otherwise the
  /// rest would mean something else to tools that skip comments.
  void expect_extension(bool is_extension) { is_extension_expected_ = is_extension; }

  /// Takes a token of this kind, described by `what`.
  std::string expect(TokenKind kind, const char* what);
  /// Takes one of these identifiers.
  std::string expect_word(std::initializer_list<const char*> words);
  /// Takes an integer from `min` to `max`.
  int expect_integer(int min, int max);

  /// Rejects the next token.
  [[noreturn]] void fail(const std::string& text) const { throw SyntaxError(token_.place, text); }

 private:
  [[nodiscard]] std::string found() const;

  Lexer lexer_;
  Token token_;
  bool is_extension_expected_ = false;
};

}  // namespace nodmap::procman
