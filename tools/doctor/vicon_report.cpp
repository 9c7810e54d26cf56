#include <algorithm>

#include <fmt/format.h>

#include "drivers/vicon/session_table.hpp"
#include "tools/doctor/vicon_doctor.hpp"

namespace vantage::tools {
namespace {

using scenario::MocapProtocol;
using wire::vicon::ServerType;

std::string address_text(const std::string& host, const ViconPort& port) {
  return port.expected.is_datagram() ? fmt::format("UDP port {}", port.port)
                                     : fmt::format("{}:{}", host, port.port);
}

bool has_seen_bodies(const Observation& observed) {
  return std::any_of(observed.bodies.begin(), observed.bodies.end(),
                     [](const auto& body) { return body.second.seen > 0; });
}

std::string first_line(const std::string& host, const ViconPort& port) {
  const std::string address = address_text(host, port);
  if (port.expected.is_datagram() && port.answer != Answer::kAccepted) {
    const std::string status = port.observed ? port.observed->status : std::string();
    return status.find(" is ") != std::string::npos || status.find("cannot") != std::string::npos
               ? status
               : address + ": no data (the UDP object stream is off or goes to another address)";
  }
  switch (port.answer) {
    case Answer::kNone:
      return address + (port.observed
                            ? ": no answer (streaming turned off, wrong host, cable or firewall)"
                            : ": no answer (wrong host, cable or firewall)");
    case Answer::kRefused:
      return address + ": connection refused (no program listens on this port)";
    case Answer::kAccepted:
      break;
  }
  if (!port.observed || port.observed->frames == 0) {
    return fmt::format("{}: {}", address, name_of(port.server_type));
  }
  return fmt::format("{}: {}, {:.1f} Hz, {} bodies, latency {:.1f} ms", address,
                     name_of(port.server_type), port.observed->rate_hz,
                     port.observed->bodies.size(), 1e3 * port.observed->latency_s);
}

void describe_stream(const ViconPort& port, std::vector<std::string>& out) {
  const Observation& observed = *port.observed;
  for (const auto& [name, body] : observed.bodies) {
    const double share = static_cast<double>(body.seen) / static_cast<double>(body.frames);
    out.push_back(
        body.seen > 0
            ? fmt::format(
                  "    {}:{} seen in {:.0f} % of the frames, last at ({:.3f}, {:.3f}, {:.3f}) m",
                  name, body.rate_hz > 0.0 ? fmt::format(" {:.1f} Hz,", body.rate_hz) : "",
                  100.0 * share, body.last_world_m.x(), body.last_world_m.y(),
                  body.last_world_m.z())
            : fmt::format("    {}: never seen", name));
  }
  for (const auto& [name, count] : observed.errors) {
    out.push_back(fmt::format("    {}: {}", name, count));
  }
  if (observed.frames == 0) {
    out.push_back("    no frames: " + observed.status);
  } else if (observed.bodies.empty()) {
    const bool is_vicon = port.expected.driver() == std::string_view("vicon");
    out.emplace_back(is_vicon ? "    frames without bodies: enable the objects in Tracker"
                              : "    frames without bodies: create and enable rigid bodies on the "
                                "server");
  } else if (!has_seen_bodies(observed) && port.server_type == ServerType::kDataStream) {
    out.emplace_back(
        "    subjects without poses: occluded, or the Kinematic Fit pipeline of Nexus is not "
        "running");
  }
  if (observed.errors.count("poses_refused") > 0 && port.server_type == ServerType::kVrpn) {
    out.emplace_back(
        "    poses are implausibly far away: check whether the server sends millimetres");
  }
}

}  // namespace

std::vector<std::string> describe(const std::string& host, const std::vector<ViconPort>& ports) {
  std::vector<std::string> out;
  const ViconPort* best = nullptr;
  for (const ViconPort& port : ports) {
    out.push_back(first_line(host, port));
    if (port.observed && port.answer == Answer::kAccepted) {
      describe_stream(port, out);
      const bool is_better =
          best == nullptr || (!has_seen_bodies(*best->observed) && has_seen_bodies(*port.observed));
      best = is_better ? &port : best;
    }
  }
  if (best == nullptr) {
    out.emplace_back(
        "no motion capture found: check that the server is running and that this is its address; "
        "for other ports use --port");
    return out;
  }
  const MocapProtocol protocol =
      drivers::vicon::protocol_of(best->server_type).value_or(best->expected);
  const std::string host_key = protocol.is_datagram() ? std::string() : ", host: " + host;
  const std::string port_key =
      best->port == protocol.default_port() ? "" : fmt::format(", port: {}", best->port);
  out.push_back(fmt::format("for the scenario: mocap: {{device: real, protocol: {}{}{}}}",
                            protocol.name(), host_key, port_key));
  return out;
}

}  // namespace vantage::tools
