#include "tools/doctor/vicon_doctor.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "bus/node/clock.hpp"
#include "core/address.hpp"
#include "core/deadline.hpp"
#include "core/process.hpp"
#include "drivers/vicon/descriptor.hpp"
#include "drivers/vicon/driver.hpp"
#include "drivers/vicon/session_table.hpp"
#include "drivers/vicon/socket_link.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::tools {
namespace {

using drivers::vicon::Descriptor;
using scenario::MocapProtocol;
using wire::vicon::ServerType;

constexpr int kConnect_ms = 1500;
constexpr int kGreeting_ms = 1500;

using Stop = std::function<bool()>;

/// Waits until `polled` is ready. Returns false after `timeout_ms` or if `stop` returns true.
bool wait_for(pollfd& polled, int timeout_ms, const Stop& stop) {
  constexpr int kSlice_ms = 50;
  for (int left_ms = timeout_ms; left_ms > 0 && !stop(); left_ms -= kSlice_ms) {
    if (poll(&polled, 1, std::min(left_ms, kSlice_ms)) > 0) {
      return true;
    }
  }
  return false;
}

/// Connects to `port` and identifies the server by its first bytes.
void probe(sockaddr_in address, ViconPort& port, const Stop& stop) {
  address.sin_port = htons(static_cast<std::uint16_t>(port.port));
  const Descriptor line(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (connect(line.fd(), as_sockaddr(address), sizeof address) != 0 && errno != EINPROGRESS) {
    return;
  }
  pollfd polled{line.fd(), POLLOUT, 0};
  if (!wait_for(polled, kConnect_ms, stop)) {
    return;
  }
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(line.fd(), SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) {
    port.answer = error == ECONNREFUSED ? Answer::kRefused : Answer::kNone;
    return;
  }
  port.answer = Answer::kAccepted;
  std::array<std::uint8_t, 64> buffer{};
  std::size_t received = 0;
  polled.events = POLLIN;
  while (port.server_type == ServerType::kTooFewBytes && wait_for(polled, kGreeting_ms, stop)) {
    const ssize_t bytes = recv(line.fd(), buffer.data() + received, buffer.size() - received, 0);
    if (bytes <= 0) {
      return;
    }
    received += static_cast<std::size_t>(bytes);
    port.server_type = wire::vicon::identify_stream(wire::vicon::Bytes(buffer).first(received));
  }
}

void note_errors(const drivers::vicon::ViconDriver& driver, Observation& observed) {
  const auto& frame = driver.frame_counts();
  const auto& wire = driver.wire_counts();
  std::vector<models::NamedCount> all{
      {"broken_streams", wire.broken_streams}, {"broken_blocks", wire.broken_blocks},
      {"unnamed_bodies", wire.unnamed_bodies}, {"frames_lost", frame.frames_lost},
      {"frames_late", frame.frames_late},      {"frames_queued", frame.frames_queued},
      {"frames_waited", frame.frames_waited},  {"frames_repeated", frame.frames_repeated},
      {"poses_refused", frame.poses_refused},  {"poses_stuck", frame.poses_stuck},
      {"poses_zero", frame.poses_zero},        {"poses_outlying", frame.poses_outlying},
      {"poses_flipped", frame.poses_flipped},  {"latencies_refused", frame.latencies_refused},
      {"names_refused", frame.names_refused}};
  for (const models::NamedCount& each : models::nonzero(std::move(all))) {
    observed.errors[each.name] = each.count;
  }
}

Observation observe(const scenario::MocapSpec& spec, const drivers::vicon::SessionRow& row,
                    Duration listen, const Stop& stop) {
  Observation observed;
  Time first{};
  Time last{};
  double latency_sum_s = 0.0;
  drivers::vicon::ViconDriver driver(spec, row, [&](const models::MocapFrame& frame) {
    first = observed.frames == 0 ? frame.arrival : first;
    last = frame.arrival;
    ++observed.frames;
    latency_sum_s += to_seconds(frame.arrival - frame.stamp.time);
    for (const models::MocapBody& body : frame.bodies) {
      ObservedBody& seen = observed.bodies[body.name];
      ++seen.frames;
      if (!body.occluded) {
        ++seen.seen;
        seen.last_world_m = body.world_from_body.translation_m;
      }
    }
  });
  const bus::SystemClock clock;
  drivers::vicon::SocketLink link(driver, [&clock] {
    return drivers::vicon::Moment{clock.now(), Duration{monotonic_ns() / 1'000}};
  });
  const std::int64_t end_ns = monotonic_ns() + listen.count() * 1'000;
  while (monotonic_ns() < end_ns && !stop()) {
    link.step();
    pollfd polled{link.wake_fd(), POLLIN, 0};
    poll(&polled, 1, 2);
  }
  if (observed.frames > 1 && last > first) {
    observed.rate_hz = static_cast<double>(observed.frames - 1) / to_seconds(last - first);
  }
  if (observed.frames > 0) {
    observed.latency_s = latency_sum_s / static_cast<double>(observed.frames);
  }
  for (const drivers::vicon::BodyRate& rate : driver.rates()) {
    if (const auto body = observed.bodies.find(rate.name); body != observed.bodies.end()) {
      body->second.rate_hz = rate.rate_hz;
    }
  }
  observed.status = driver.status();
  observed.has_data = driver.has_data();
  note_errors(driver, observed);
  return observed;
}

}  // namespace

std::vector<ViconPort> examine_vicon(const std::string& host, const std::vector<int>& tcp_ports,
                                     int udp_port, Duration listen, const Stop& stop) {
  const sockaddr_in address = [&host] {
    const DefaultSignalScope looking_up;  // a name look-up may block for a long time
    return require_host(host, 0);
  }();
  std::vector<ViconPort> out;
  scenario::MocapSpec spec;
  spec.host = host;
  for (const int number : tcp_ports) {
    if (stop()) {
      return out;
    }
    ViconPort port;
    port.port = number;
    port.expected = number == MocapProtocol::kVrpn.default_port() ? MocapProtocol::kVrpn
                                                                  : MocapProtocol::kDataStream;
    probe(address, port, stop);
    const auto protocol = drivers::vicon::protocol_of(port.server_type);
    if (protocol && !protocol->is_datagram()) {
      spec.protocol = *protocol;
      spec.port = number;
      port.observed = observe(spec, drivers::vicon::session_row(spec.protocol), listen, stop);
    }
    out.push_back(std::move(port));
  }
  if (stop()) {
    return out;
  }
  ViconPort datagrams;
  datagrams.expected = MocapProtocol::kObjectStream;
  datagrams.port = udp_port;
  spec.protocol = MocapProtocol::kObjectStream;
  spec.port = udp_port;
  datagrams.observed = observe(spec, drivers::vicon::session_row(spec.protocol), listen, stop);
  if (datagrams.observed->frames > 0) {
    datagrams.answer = Answer::kAccepted;
    datagrams.server_type = ServerType::kObjectStream;
  }
  out.push_back(std::move(datagrams));
  return out;
}

ViconPort examine_server(const std::string& host, const drivers::vicon::SessionRow& row, int port,
                         Duration listen, const Stop& stop) {
  const sockaddr_in address = [&host] {
    const DefaultSignalScope looking_up;  // a name look-up may block for a long time
    return require_host(host, 0);
  }();
  scenario::MocapSpec spec;
  spec.host = host;
  spec.protocol = row.protocol;
  spec.port = port;
  ViconPort out;
  out.expected = row.protocol;
  out.port = spec.actual_port();
  const bool is_stream = row.protocol.transport() == scenario::MocapTransport::kTcp;
  if (is_stream) {
    probe(address, out, stop);
  }
  if (is_stream && out.server_type != row.server_type) {
    return out;
  }
  out.observed = observe(spec, row, listen, stop);
  if (out.observed->has_data) {
    out.answer = Answer::kAccepted;
    out.server_type = row.server_type;
  }
  return out;
}

bool is_usable(const std::vector<ViconPort>& ports) {
  return std::any_of(ports.begin(), ports.end(), [](const ViconPort& port) {
    return port.observed && std::any_of(port.observed->bodies.begin(), port.observed->bodies.end(),
                                        [](const auto& body) { return body.second.seen > 0; });
  });
}

}  // namespace vantage::tools
