// SPDX-License-Identifier: BSD-3-Clause
// Who may do what, decided from the head of a request alone.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "modules/viewer/session.hpp"

namespace nodmap::viewer {

/// The parts of a WebSocket request that decide about access; empty where a header is missing.
struct Request {
  std::string target;     ///< path and query
  std::string host;       ///< header Host
  std::string origin;     ///< header Origin; a program that is no browser sends none
  std::string protocols;  ///< header Sec-WebSocket-Protocol
};

struct AccessPolicy {
  bool loopback_only = true;  ///< the server listens on this host alone
  std::string token;          ///< empty: nobody may control
};

enum class Refusal { kNone, kHost, kProtocol, kToken };

struct Access {
  Refusal refusal = Refusal::kNone;
  std::string protocol;  ///< the one to answer with
  Rights rights;
};

/// Whether a Host header names this host. Checked where only this host is served: otherwise a page
/// from elsewhere could let its own name point to 127.0.0.1 and count as ours.
[[nodiscard]] bool is_this_host(std::string_view host);

/// The first of ours among the protocols offered.
[[nodiscard]] std::optional<std::string> choose_protocol(std::string_view offered);

/// Reading is free (Foxglove's page comes from another origin); steering a playback is for our own
/// page and for programs; control needs the token besides. A wrong token is refused, not ignored.
[[nodiscard]] Access decide_access(const Request& request, const AccessPolicy& policy);

/// 128 random bits as hexadecimal digits.
[[nodiscard]] std::string make_token();

}  // namespace nodmap::viewer
