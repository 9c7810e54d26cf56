#include "drivers/contacts/app/node.hpp"

#include <utility>

#include "bus/convert/channels.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kIdle = std::chrono::seconds(1);

}  // namespace

ContactsNode::ContactsNode(bus::Bus& bus, const bus::Clock& clock,
                           const scenario::Scenario& scenario)
    : judge_(scenario), next_tick_(clock.now() + kIdle) {
  bus.subscribe<models::MocapFrame>(
      bus::kVicon, [this, &bus, &clock](const models::MocapFrame& frame) {
        for (models::CollisionReport& contact : judge_.on_frame(frame, clock.now())) {
          bus.publish(bus::kCollision, std::move(contact));
        }
      });
  bus.subscribe<models::VehicleStatus>(
      bus::vehicle_channel("*"),
      [this](const models::VehicleStatus& status) { judge_.on_status(status); });
  bus.subscribe<models::TruthFrame>(
      bus::kTruth, [this](const models::TruthFrame& truth) { judge_.on_truth(truth); });
}

void ContactsNode::tick(Time now) { next_tick_ = now + kIdle; }

}  // namespace vantage::drivers
