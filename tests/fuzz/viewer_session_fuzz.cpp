// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the frames of a client of the viewer, separated by newlines; text if the first byte
// is T. The session stays usable and answers with JSON, and what waits for the client stays
// bounded.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "modules/viewer/session.hpp"

namespace {

using namespace nodmap;          // NOLINT(google-build-using-namespace): a program of one page
using namespace nodmap::viewer;  // NOLINT(google-build-using-namespace)

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void receive(Session& session, std::string_view frame) {
  if (frame.starts_with('T')) {
    session.receive_text(frame.substr(1));
  } else {
    session.receive_binary(std::as_bytes(std::span(frame)), 0s);
  }
}

void drain(Session& session) {
  std::size_t frames = 0;
  while (const auto frame = session.next()) {
    require(++frames <= Session::kMaxWaiting + Session::kMaxSubscriptions);
    require(frame->is_binary || Json::accept(frame->head));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  foxglove::TopicStore store;
  store.add({"SCAN", "foxglove.LaserScan"});
  store.post(0, time::Timestamp(1us), [] { return std::string("{}"); });
  Services services;
  services.parameters = [] { return Json::array(); };
  services.set_parameter = [](const std::string&, const Json&) { return std::string(); };
  services.control = [](const Json& request, time::Duration) {
    require(request.is_object());
    return Answer{.ok = request.contains("do"), .text = "said"};
  };
  Session session(store, services, {.may_play = true, .may_control = true});
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  while (!rest.empty()) {
    const std::string_view frame = rest.substr(0, rest.find('\n'));
    receive(session, frame);
    rest.remove_prefix(std::min(frame.size() + 1, rest.size()));
  }
  drain(session);
  return 0;
}
