// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/senders.hpp"

namespace nodmap::procman {

bool Senders::take_own(const Discovery& discovery, const bus::Sender& sender) {
  if (discovery.transmitter_id != id_ || discovery.nonce != nonce_) {
    return false;
  }
  own_ = own_.value_or(sender);
  return true;
}

bool Senders::is_impostor(const bus::Sender& sender) const {
  return own_ && sender != *own_;
}

}  // namespace nodmap::procman
