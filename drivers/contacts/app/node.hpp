#pragma once

#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/time.hpp"
#include "drivers/contacts/contact_judge.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Bus node of vantage-contacts: subscribes to VICON, VEHICLE_* and TRUTH, and publishes COLLISION
/// for contacts of real bodies.
class ContactsNode : public bus::Node {
 public:
  ContactsNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario);

  [[nodiscard]] std::string name() const override { return "CONTACTS"; }
  /// All work is done when frames arrive; the tick does nothing.
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    return judge_.counters();
  }

 private:
  ContactJudge judge_;
  Time next_tick_;
};

}  // namespace vantage::drivers
