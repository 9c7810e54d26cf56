#include "trial/observe/announcer.hpp"

#include <chrono>
#include <utility>

namespace vantage::trial {

Announcer::Announcer(bus::Bus& bus, const scenario::Scenario& scenario, std::string process)
    : bus_(bus) {
  notice_.yaml = scenario.source_text;
  notice_.version = version();
  notice_.process = std::move(process);
}

void Announcer::publish(Time now) {
  notice_.stamp.time = now;
  bus_.publish(bus::kScenario, notice_);
  next_ = now + std::chrono::seconds(5);
}

void Announcer::tick(Time now) {
  if (now >= next_) {
    publish(now);
  }
}

}  // namespace vantage::trial
