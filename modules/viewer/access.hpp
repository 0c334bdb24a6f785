// SPDX-License-Identifier: BSD-3-Clause
// Decides what a client may do, from the head of its request alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "modules/viewer/session.hpp"

namespace nodmap::viewer {

/// The parts of a WebSocket request that decide about access; empty where a header is missing.
struct Request {
  std::string target;     ///< path and query
  std::string host;       ///< header Host
  std::string origin;     ///< header Origin; sent by browsers only
  std::string protocols;  ///< header Sec-WebSocket-Protocol
};

struct AccessPolicy {
  bool loopback_only = true;  ///< the server listens on the loopback address only
  std::string token;          ///< empty: no client may control
};

enum class Refusal : std::uint8_t { kNone, kHost, kProtocol, kToken };

struct Access {
  Refusal refusal = Refusal::kNone;
  std::string protocol;  ///< the protocol to answer with
  Rights rights;
};

/// Whether a Host header names this host. Checked when only this host is served. Otherwise a
/// foreign page could let its own name point to 127.0.0.1 and count as ours (DNS rebinding).
[[nodiscard]] bool is_this_host(std::string_view host);

/// The first of the offered protocols that we support, if any.
[[nodiscard]] std::optional<std::string> choose_protocol(std::string_view offered);

/// Everyone may read (Foxglove's page comes from another origin). Only our own page and programs
/// may control a playback; controlling the robot also requires the token. A wrong token is refused,
/// not ignored.
[[nodiscard]] Access decide_access(const Request& request, const AccessPolicy& policy);

/// 128 random bits as hexadecimal digits.
[[nodiscard]] std::string make_token();

}  // namespace nodmap::viewer
