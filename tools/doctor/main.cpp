// SPDX-License-Identifier: BSD-3-Clause
// nodmap-doctor: finds what keeps nodmap from working on this host, and the commands that fix it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "common/bus/codec.hpp"
#include "common/bus/live_bus.hpp"
#include "common/node/program.hpp"
#include "common/node/serial_workers.hpp"
#include "tools/doctor/host.hpp"
#include "tools/doctor/network.hpp"
#include "tools/doctor/probe.hpp"
#include "tools/doctor/self_test.hpp"

namespace nodmap::doctor {
namespace {

std::set<std::int64_t> our_fingerprints() {
  std::set<std::int64_t> fingerprints;
  for (const bus::MessageType& type : bus::message_types()) {
    fingerprints.insert(type.fingerprint);
  }
  return fingerprints;
}

std::vector<Finding> examine_network(const std::string& url) {
  std::vector<Finding> findings;
  const std::optional<bus::UdpmUrl> udpm = bus::parse_udpm_url(url);
  if (udpm) {
    findings.push_back(
        check_multicast_route(read_text("/proc/net/route").value_or(""), *udpm, interface_flags()));
    findings.push_back(
        check_rmem_default(read_text("/proc/sys/net/core/rmem_default").value_or("")));
    findings.push_back(check_rmem_max(read_text("/proc/sys/net/core/rmem_max").value_or("")));
    const auto sockets = parse_udp_sockets(read_text("/proc/net/udp").value_or(""));
    const auto owners = socket_owners();
    findings.push_back(check_port_users(sockets, owners, udpm->port));
    findings.push_back(check_drops(sockets, owners, udpm->port));
  }
  const char* trusted_hosts = std::getenv("NODMAP_TRUSTED_HOSTS");  // NOLINT(concurrency-mt-unsafe)
  const Finding trust = check_trusted_hosts(trusted_hosts != nullptr ? trusted_hosts : "",
                                            udpm.value_or(bus::UdpmUrl{}));
  findings.push_back(trust);
  if (trust.status == Status::kFail) {
    return findings;  // no process can start without it
  }
  const SelfTest test = run_self_test(url, std::chrono::seconds(1));
  findings.push_back(check_self_test(test, url));
  if (udpm && test.opened) {
    findings.push_back(check_traffic(test.received, our_fingerprints(), *udpm));
  }
  return findings;
}

// Listens for two seconds: a process that runs sends its STATUS, or PM_INFO, once a second.
std::vector<Finding> examine_silence(const std::string& url) {
  const SelfTest test = run_self_test(url, std::chrono::seconds(2));
  std::vector<Finding> findings = {check_self_test(test, url)};
  if (test.opened) {
    findings.push_back(
        check_silence(test.received, bus::parse_udpm_url(url).value_or(bus::UdpmUrl{})));
  }
  return findings;
}

std::vector<Finding> examine_host(const std::string& logs) {
  const auto file_exists = [](const char* file) { return std::filesystem::exists(file); };
  const auto spy = find_program("lcm-spy");
  return {
      check_disk(logs, available_bytes(logs)),
      check_present("lcm-logplayer", "lcm-logplayer", find_program("lcm-logplayer").has_value(),
                    "it plays back recordings", "sudo apt install liblcm-bin"),
      check_present("java", "java", find_program("java").has_value(), "lcm-spy needs it",
                    "sudo apt install default-jre"),
      check_spy_script(spy ? read_text(*spy) : std::nullopt),
      check_present("lcm.jar", "lcm.jar", file_exists("/usr/share/java/lcm.jar"),
                    "it contains lcm-spy", "sudo apt install liblcm-java"),
      check_present("jchart2d.jar", "jchart2d.jar", file_exists("/usr/share/java/jchart2d.jar"),
                    "lcm-spy needs it for plots", "sudo apt install libjchart2d-java"),
      check_present("types jar", "lcmtypes_nodmap.jar",
                    file_exists("build/java/lcmtypes_nodmap.jar") ||
                        file_exists("/usr/share/java/lcmtypes_nodmap.jar"),  // of the package
                    "it lets lcm-spy decode our messages", "./nodmap spy"),
      check_realtime(realtime_is_permitted()),
      check_serial_workers(node::may_raise_serial_workers()),
      check_clock(clock_is_synchronized()),
  };
}

std::string name_of(Status status) {
  switch (status) {
    case Status::kOk:
      return "OK";
    case Status::kWarn:
      return "WARN";
    case Status::kFail:
      break;
  }
  return "FAIL";
}

void print_text(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    std::string status = name_of(finding.status);
    status.resize(5, ' ');
    std::cout << status << finding.check << ": " << finding.sentence << "\n";
    if (!finding.command.empty()) {
      std::cout << "       " << finding.command << "\n";
    }
  }
}

void print_json(const std::vector<Finding>& findings) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Finding& finding : findings) {
    rows.push_back({{"check", finding.check},
                    {"status", name_of(finding.status)},
                    {"sentence", finding.sentence},
                    {"command", finding.command}});
  }
  // Names of files, processes and channels may be any bytes, but JSON is UTF-8.
  std::cout << rows.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
}

struct Arguments {
  std::string logs = "logs";
  bool json = false;
  bool silence = false;
};

int run(const Arguments& arguments, const std::string& lcm_url) {
  const std::string url = bus::resolve_url(lcm_url);
  std::vector<Finding> findings = arguments.silence ? examine_silence(url) : examine_network(url);
  if (!arguments.silence) {
    std::ranges::move(examine_host(arguments.logs), std::back_inserter(findings));
  }
  arguments.json ? print_json(findings) : print_text(findings);
  const bool any_failed = std::ranges::any_of(
      findings, [](const Finding& finding) { return finding.status == Status::kFail; });
  return any_failed ? 1 : 0;
}

}  // namespace
}  // namespace nodmap::doctor

int main(int argc, char** argv) {
  using namespace nodmap;
  doctor::Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-doctor",
       .summary =
           "Finds what keeps nodmap from working on this host, and the command that fixes it.",
       .uses_lcm = true,
       .add_options =
           [&arguments](CLI::App& app) {
             app.add_option("--logs", arguments.logs, "Folder of the recordings")
                 ->capture_default_str();
             app.add_flag("--json", arguments.json, "Print the findings as JSON");
             app.add_flag("--silence", arguments.silence,
                          "Check only that nobody else sends on the bus");
           },
       .run =
           [&arguments](const std::string& lcm_url) { return doctor::run(arguments, lcm_url); }});
}
