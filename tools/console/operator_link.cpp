#include "tools/console/operator_link.hpp"

#include <utility>

#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::tools {

OperatorLink::OperatorLink(const std::string& url, const std::string& scenario) : url_(url) {
  std::unique_ptr<bus::auth::Authenticator> authenticator;
  if (!scenario.empty()) {
    const scenario::Scenario loaded = scenario::load_scenario(scenario);
    bus::auth::require_operator(loaded);
    authenticator = bus::auth::authenticator_for(loaded);
    url_ = url_.empty() ? loaded.network.url : url_;
  }
  authenticator_ = authenticator.get();
  transport_ = bus::open_transport(url_);
  bus_ = std::make_unique<bus::Bus>(*transport_, bus::random_run_id());
  bus_->use_clock(clock_);
  bus_->secure(std::move(authenticator), clock_);
}

}  // namespace vantage::tools
