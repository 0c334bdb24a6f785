// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::procman {

/// The other sheriffs, by their orders on the network. One counts as running when it repeats its
/// orders from the same socket, as every sheriff does once a second: a single message may be
/// forged, and must not make a sheriff yield.
class OtherSheriffs {
 public:
  /// A sheriff counts as ended when it has given no orders for this long.
  static constexpr time::Duration kSilence = 3s;
  /// Orders are repeated if this time has passed since the first ones. A sheriff sends some at once
  /// when it has something new to say.
  static constexpr time::Duration kRepeated = 500ms;

  /// Takes orders of another sheriff.
  void take(const std::string& sheriff_id, const bus::Sender& sender, time::SteadyTime now);

  /// The id of a running sheriff; of several, of one of them.
  [[nodiscard]] std::optional<std::string> running(time::SteadyTime now) const;

  /// The same, also if it has not repeated its orders, so that they may be forged.
  [[nodiscard]] std::optional<std::string> received(time::SteadyTime now) const;

 private:
  struct Source {
    std::string sheriff_id;
    time::SteadyTime first;  // orders
    time::SteadyTime last;
  };
  [[nodiscard]] std::optional<std::string> find(time::SteadyTime now,
                                                time::Duration repeated) const;

  std::map<bus::Sender, Source> sources_;
};

}  // namespace nodmap::procman
