// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/followed_sender.hpp"
#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"
#include "procman/protocol/messages.hpp"

namespace nodmap::procman {

/// Who sends what a deputy receives, by socket: a process may write any name into a message, but
/// cannot send it from another one's socket.
class Senders {
 public:
  /// A sheriff is followed until it has been silent for this long: three of its orders.
  static constexpr time::Duration kSheriffSilence = 3s;

  /// `id`: the deputy's name. `nonce`: a number in its discovery messages, by which it recognises
  /// them.
  Senders(std::string id, std::int64_t nonce) : id_(std::move(id)), nonce_(nonce) {}

  [[nodiscard]] std::int64_t nonce() const { return nonce_; }

  /// Takes a discovery message; returns whether it is the deputy's own, come back. The first such
  /// message tells the deputy its own socket.
  [[nodiscard]] bool take_own(const Discovery& discovery, const bus::Sender& sender);

  /// Whether the sender of a report in the deputy's name is another process. Unknown (false) until
  /// the deputy's first own message has come back.
  [[nodiscard]] bool is_impostor(const bus::Sender& sender) const;

  /// Adds orders; returns whether they are from the sheriff that is followed. `arrived`: see
  /// bus::Origin; a deputy that was frozen reads them later.
  [[nodiscard]] bool follow_sheriff(const bus::Sender& sender, time::SteadyTime arrived) {
    return sheriff_.follow(sender, arrived);
  }

  /// Adds that a sheriff has ended; returns whether it was followed.
  bool end_sheriff(const bus::Sender& sender) { return sheriff_.end(sender); }

 private:
  std::string id_;
  std::int64_t nonce_;
  std::optional<bus::Sender> own_;
  bus::FollowedSender sheriff_{kSheriffSilence};
};

}  // namespace nodmap::procman
