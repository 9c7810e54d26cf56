#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "drivers/vicon/session_table.hpp"
#include "scenario/mocap_spec.hpp"
#include "wire/vicon/identify.hpp"

namespace vantage::tools {

/// Response of one port to a connection.
enum class Answer {
  kNone,      ///< no response: wrong host, cable, firewall
  kRefused,   ///< the host refuses the connection: no server listens there
  kAccepted,  ///< the connection is accepted; see ViconPort::server_type
};

struct ObservedBody {
  std::int64_t frames = 0;  ///< frames that list the body
  std::int64_t seen = 0;    ///< frames in which the body is not occluded
  Eigen::Vector3d last_world_m = Eigen::Vector3d::Zero();
  double rate_hz = 0.0;  ///< Hz; report rate of the body if bodies have separate rates, else 0
};

/// Result of receiving a stream with the mocap driver.
struct Observation {
  std::int64_t frames = 0;
  double rate_hz = 0.0;
  double latency_s = 0.0;  ///< s; mean of arrival time minus capture time
  std::map<std::string, ObservedBody> bodies;
  std::map<std::string, std::int64_t> errors;  ///< error counters that are not zero
  std::string status;                          ///< status text of the driver
  bool has_data = false;                       ///< true: the server sent data of any kind
};

struct ViconPort {
  scenario::MocapProtocol expected = scenario::MocapProtocol::kDataStream;
  int port = 0;
  Answer answer = Answer::kNone;
  wire::vicon::ServerType server_type = wire::vicon::ServerType::kTooFewBytes;
  std::optional<Observation> observed;  ///< nullopt if the port has no mocap protocol
};

/// Identifies the mocap servers of `host` at `tcp_ports`, and the object stream that arrives at
/// `udp_port`. Receives each stream for the time `listen`; each port takes up to 3 s longer. After
/// `stop` the function returns within 0.1 s, without the ports that have not been examined yet.
/// @throws StartupError if the host is unknown.
std::vector<ViconPort> examine_vicon(
    const std::string& host, const std::vector<int>& tcp_ports, int udp_port, Duration listen,
    const std::function<bool()>& stop = [] { return false; });

/// Receives the stream of a mocap server of the kind `row` at `port` (0: default port) for the time
/// `listen`. After `stop` the function returns within 0.1 s.
/// @throws StartupError if the host is unknown.
ViconPort examine_server(
    const std::string& host, const drivers::vicon::SessionRow& row, int port, Duration listen,
    const std::function<bool()>& stop = [] { return false; });

/// Returns the findings as text, then the remedy: the scenario's `mocap` if a server was found.
std::vector<std::string> describe(const std::string& host, const std::vector<ViconPort>& ports);

/// True if a stream contains a body that was visible.
bool is_usable(const std::vector<ViconPort>& ports);

}  // namespace vantage::tools
