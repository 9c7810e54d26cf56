#pragma once

#include <memory>
#include <string>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"

namespace vantage::tools {

/// Connection of an operator station to the bus, for the console and the operator page. With a
/// scenario, the station signs its commands with the scenario's operator key.
class OperatorLink {
 public:
  /// @param url       LCM URL; empty: the scenario's URL, or $LCM_DEFAULT_URL without one
  /// @param scenario  path of a scenario file; empty: commands are not signed
  /// @throws StartupError if the scenario, its keys or the network cannot be used.
  OperatorLink(const std::string& url, const std::string& scenario);

  [[nodiscard]] bus::Bus& bus() { return *bus_; }
  [[nodiscard]] const bus::Clock& clock() const { return clock_; }
  /// Returns the authenticator of the bus; nullptr: messages are not signed.
  [[nodiscard]] const bus::auth::Authenticator* authenticator() const { return authenticator_; }
  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  bus::SteadyClock clock_;
  std::string url_;
  std::unique_ptr<bus::Transport> transport_;
  const bus::auth::Authenticator* authenticator_ = nullptr;  ///< belongs to bus_
  std::unique_ptr<bus::Bus> bus_;
};

}  // namespace vantage::tools
