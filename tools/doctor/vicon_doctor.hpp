#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "scenario/mocap_spec.hpp"
#include "wire/vicon/identify.hpp"

namespace vantage::tools {

/// What answers at one TCP port.
enum class Answer {
  kNone,     ///< no answer: wrong host, cable, firewall
  kRefused,  ///< the host is there, nobody listens
  kSpeech,   ///< somebody accepts; see ViconPort::speaker
};

struct ObservedBody {
  std::int64_t frames = 0;  ///< in which it was listed
  std::int64_t seen = 0;
  Eigen::Vector3d last_world_m = Eigen::Vector3d::Zero();
  double rate_hz = 0.0;  ///< of its own reports, where each body has its own; else 0
};

/// What a driver made of a stream.
struct Observation {
  std::int64_t frames = 0;
  double rate_hz = 0.0;
  double latency_s = 0.0;  ///< mean of arrival less capture
  std::map<std::string, ObservedBody> bodies;
  std::map<std::string, std::int64_t> troubles;  ///< counters that are not zero
  std::string status;                            ///< the driver's own word
};

struct ViconPort {
  scenario::MocapProtocol expected = scenario::MocapProtocol::kDataStream;
  int port = 0;
  Answer answer = Answer::kNone;
  wire::vicon::Speaker speaker = wire::vicon::Speaker::kTooFewBytes;
  std::optional<Observation> observed;  ///< when a mocap protocol is spoken there
};

/// Looks who speaks at `host`: at `ports` by TCP, each with the protocol that is usual there, and
/// what comes to `udp_port`; listens to each stream for `listen`. Takes that long and up to 3 s a
/// port; told to `stop`, it returns within 0.1 s what it has, the ports that it did not come to
/// left out. @throws StartupError when no such host is known.
std::vector<ViconPort> examine_vicon(
    const std::string& host, const std::vector<int>& tcp_ports, int udp_port, Duration listen,
    const std::function<bool()>& stop = [] { return false; });

/// The findings in words, then what to do: the scenario's `mocap` when something was found.
std::vector<std::string> describe(const std::string& host, const std::vector<ViconPort>& ports);

/// Some stream has bodies that are seen.
bool is_usable(const std::vector<ViconPort>& ports);

}  // namespace vantage::tools
