#include <utility>

#include "bus/transport/lcm_transport.hpp"
#include "bus/transport/transport.hpp"
#include "bus/transport/udpm_transport.hpp"
#include "bus/transport/url.hpp"
#include "core/check.hpp"

namespace vantage::bus {

namespace {

/// @param report called when the network is lost or returns; nullptr: a missing network is an error
std::unique_ptr<Transport> open(const std::string& url, ReportNetwork report) {
  const std::string chosen = url_or_default(url);
  const Url parsed = parse_url(chosen);
  if (parsed.scheme == "udpm") {
    return std::make_unique<udpm::UdpmTransport>(parse_udpm(parsed), std::move(report));
  }
  if (parsed.scheme == "memq" || parsed.scheme == "file") {
    return std::make_unique<LcmTransport>(chosen);
  }
  throw StartupError("LCM url '" + chosen + "': unknown scheme (udpm, memq, file)");
}

}  // namespace

std::unique_ptr<Transport> open_transport(const std::string& url) { return open(url, nullptr); }

std::unique_ptr<Transport> open_waiting_transport(const std::string& url, ReportNetwork report) {
  return open(url, std::move(report));
}

}  // namespace vantage::bus
