#include "drivers/vehicle/driver_end.hpp"

namespace vantage::drivers {

void DriverEnd::request(int requests, Time now) {
  if (requests > 0) {
    requested_at_ = requested_at_.value_or(now);
  }
  if (requests > 1) {
    hurried_at_ = hurried_at_.value_or(now);
  }
}

void DriverEnd::step(const EndFacts& facts, Time now) {
  if (!requested_at_ || may_end_) {
    return;
  }
  if (!hurried_at_ && now - *requested_at_ >= landing_) {
    hurried_at_ = now;
  }
  switch (facts.in_flight) {
    case InFlight::kNo:
      end();
      return;
    case InFlight::kUnknown:
      if (now - started_ >= kSearch) {
        end();
      }
      return;
    case InFlight::kYes:
      break;
  }
  if (facts.is_pilots) {
    end("a pilot flies the vehicle by hand: the driver ends without landing it");
  } else if (hurried_at_ && facts.lands_itself) {
    end();
  } else if (hurried_at_ && now - *hurried_at_ >= kHurry) {
    end("the vehicle has not confirmed that it is landing or stationary: the driver ends anyway");
  }
}

}  // namespace vantage::drivers
