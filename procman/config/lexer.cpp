// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/lexer.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "common/formats/number.hpp"

namespace nodmap::procman {
namespace {

constexpr std::string_view kExtension = "#nodmap:";

// Not those of <cctype>, so that a configuration means the same in every locale.
bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool begins_identifier(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_in_identifier(char c) {
  return begins_identifier(c) || is_digit(c) || c == '-';
}

TokenKind symbol(char c) {
  switch (c) {
    case '=':
      return TokenKind::kAssign;
    case ';':
      return TokenKind::kSemicolon;
    case '{':
      return TokenKind::kOpen;
    case '}':
      return TokenKind::kClose;
    default:
      return TokenKind::kEnd;
  }
}

std::string printable(char c) {
  if (c > ' ' && c < '\x7F') {
    return std::string("'") + c + "'";
  }
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "byte 0x%02X", static_cast<unsigned char>(c));
  return text.data();
}

char unescaped(char c) {
  switch (c) {
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return c;
  }
}

}  // namespace

Token Lexer::next() {
  skip_blanks_and_comments();
  Token token;
  token.place = place_;
  token.is_extension = in_extension_;
  if (at_end()) {
    return token;
  }
  const char c = peek();
  if (symbol(c) != TokenKind::kEnd) {
    token.kind = symbol(c);
    token.text = take();
  } else if (c == '"') {
    token.kind = TokenKind::kString;
    token.text = take_string(token.place);
  } else if (begins_identifier(c)) {
    token.kind = TokenKind::kIdentifier;
    token.text = take_while(is_in_identifier);
  } else if (is_digit(c)) {
    token.kind = TokenKind::kInteger;
    token.text = take_while(is_digit);
  } else {
    throw SyntaxError(place_, "unexpected " + printable(c));
  }
  return token;
}

char Lexer::take() {
  const char c = text_[at_++];
  if (c == '\n') {
    ++place_.line;
    place_.column = 1;
    in_extension_ = false;
  } else {
    ++place_.column;
  }
  return c;
}

void Lexer::skip_blanks_and_comments() {
  while (!at_end()) {
    if (is_space(peek())) {
      take();
    } else if (peek() == '#') {
      begin_comment();
    } else {
      return;
    }
  }
}

void Lexer::begin_comment() {
  if (!in_extension_ && text_.substr(at_).starts_with(kExtension)) {
    in_extension_ = true;
    for (std::size_t i = 0; i < kExtension.size(); ++i) {
      take();
    }
    return;
  }
  while (!at_end() && peek() != '\n') {
    take();
  }
}

std::string Lexer::take_string(Place begin) {
  std::string text;
  take();  // the opening quote
  while (!at_end() && peek() != '\n') {
    char c = take();
    if (c == '"') {
      return text;
    }
    if (c == '\0') {
      throw SyntaxError(begin, "a string must not contain a zero byte");
    }
    if (c == '\\') {
      if (at_end() || peek() == '\n') {
        break;
      }
      c = unescaped(take());
    }
    text += c;
  }
  throw SyntaxError(begin, "the string is not closed on its line");
}

template <class Predicate>
std::string Lexer::take_while(Predicate belongs) {
  std::string text;
  while (!at_end() && belongs(peek())) {
    text += take();
  }
  return text;
}

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
  const bool fits =
      token_.kind == TokenKind::kIdentifier && std::ranges::find(words, token_.text) != words.end();
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
  const auto value = formats::parse_number<int>(text);
  if (!value || *value < min || *value > max) {
    throw SyntaxError(
        place, text + " is not within " + std::to_string(min) + " to " + std::to_string(max));
  }
  return *value;
}

}  // namespace nodmap::procman
