// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/exec_line.hpp"

#include <algorithm>

namespace nodmap::procman {
namespace {

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

bool is_in_name(char c, bool is_first) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         (!is_first && c >= '0' && c <= '9');
}

/// The word that begins at `at`, which moves behind it.
std::string take_word(std::string_view line, std::size_t& at) {
  std::string word;
  char quote = '\0';
  for (; at < line.size() && (quote != '\0' || !is_blank(line[at])); ++at) {
    const char c = line[at];
    if (c == '\\') {
      word += at + 1 < line.size() ? line[++at] : c;
    } else if (quote == '\0' && (c == '\'' || c == '"')) {
      quote = c;
    } else if (quote != '\0' && c == quote) {
      quote = '\0';
    } else {
      word += c;
    }
  }
  return word;
}

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && is_blank(line[at])) {
      ++at;
    }
    if (at == line.size()) {
      return words;
    }
    words.push_back(take_word(line, at));
  }
}

/// The name of the variable at the beginning of `text` (behind the $), and how long it is with its
/// braces; an empty name where there is none.
std::pair<std::string, std::size_t> variable_at(std::string_view text) {
  const bool has_brace = text.starts_with('{');
  std::size_t end = has_brace ? 1 : 0;
  const std::size_t begin = end;
  while (end < text.size() && is_in_name(text[end], end == begin)) {
    ++end;
  }
  std::string name(text.substr(begin, end - begin));
  if (has_brace && (end == text.size() || text[end] != '}')) {
    return {{}, 0};
  }
  return {std::move(name), end + (has_brace ? 1 : 0)};
}

std::string expanded(std::string_view word, const Lookup& lookup) {
  std::string text;
  for (std::size_t at = 0; at < word.size(); ++at) {
    if (word[at] != '$') {
      text += word[at];
      continue;
    }
    const auto [name, length] = variable_at(word.substr(at + 1));
    const std::optional<std::string> value = name.empty() ? std::nullopt : lookup(name);
    if (value) {
      text += *value;
      at += length;
    } else {
      text += '$';
    }
  }
  return text;
}

}  // namespace

ExecLine parse_exec_line(std::string_view line, const Lookup& lookup) {
  ExecLine exec;
  for (const std::string& word : words_of(line)) {
    const std::size_t assign = word.find('=');
    if (exec.arguments.empty() && assign != std::string::npos && assign > 0) {
      exec.environment.emplace_back(word.substr(0, assign), word.substr(assign + 1));
    } else {
      exec.arguments.push_back(expanded(word, lookup));
    }
  }
  return exec;
}

}  // namespace nodmap::procman
