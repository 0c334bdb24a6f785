// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/exec_line.hpp"

#include <cstddef>

namespace nodmap::procman {
namespace {

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

// The word that begins at `at`; moves `at` behind it.
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

}  // namespace

ExecLine split_exec_line(std::string_view line) {
  ExecLine exec;
  for (std::string& word : words_of(line)) {
    const std::size_t assign = word.find('=');
    if (exec.arguments.empty() && assign != std::string::npos && assign > 0) {
      exec.environment.emplace_back(word.substr(0, assign), word.substr(assign + 1));
    } else {
      exec.arguments.push_back(std::move(word));
    }
  }
  return exec;
}

std::string program_of(std::string_view exec) {
  const std::vector<std::string> words = split_exec_line(exec).arguments;
  return words.empty() ? std::string() : words.front().substr(words.front().rfind('/') + 1);
}

}  // namespace nodmap::procman
