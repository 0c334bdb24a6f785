// SPDX-License-Identifier: BSD-3-Clause
#include "common/params/suggestion.hpp"

#include <algorithm>
#include <limits>

namespace nodmap::params {
namespace {

// Number of typing errors between two words: the optimal string alignment distance, computed row
// by row.
std::size_t typing_errors(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = a[i - 1] == b[j - 1];
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
  }
  return row[b.size()];
}

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  const std::string* nearest = nullptr;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : known) {
    const std::string_view last_part = std::string_view(candidate).substr(candidate.rfind('.') + 1);
    const std::size_t errors =
        std::min(typing_errors(word, candidate), typing_errors(word, last_part));
    if (errors < fewest) {
      fewest = errors;
      nearest = &candidate;
    }
  }
  return nearest != nullptr && 3 * fewest <= word.size() ? "; did you mean '" + *nearest + "'?"
                                                         : std::string();
}

}  // namespace nodmap::params
