#include "trial/virtual_loop.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace vantage::trial {

VirtualTimeLoop::VirtualTimeLoop(Time start, const scenario::Scenario& scenario) : clock_(start) {
  const scenario::NetworkSpec& spec = scenario.network;
  limited_ = spec.budget_kbitps > 0.0 ? &scenario : nullptr;
  if (limited_ != nullptr || spec.simulation.loss > 0.0 || spec.simulation.rate_kbitps > 0.0) {
    network_ = std::make_unique<SimulatedNetwork>(scenario, clock_);
    hub_.use_network(network_.get());
  }
}

bus::Bus& VirtualTimeLoop::add_bus(std::int64_t run_id, const std::string& host) {
  Participant participant;
  waiting_.push_back(0);
  participant.transport = hub_.connect(
      [this, index = participants_.size()] {
        waiting_count_ += waiting_[index] == 0 ? 1U : 0U;
        waiting_[index] = 1;
      },
      host);
  participant.bus = std::make_unique<bus::Bus>(*participant.transport, run_id);
  if (limited_ != nullptr) {
    participant.bus->limit_air(std::make_unique<bus::AirBudget>(*limited_), clock_);
  }
  participants_.push_back(std::move(participant));
  return *participants_.back().bus;
}

void VirtualTimeLoop::add_node(const NodeRecipe& recipe, std::int64_t run_id) {
  add_bus(run_id, recipe.host);
  Participant& participant = participants_.back();
  participant.node = recipe.make(*participant.bus, clock_);
  participant.health = std::make_unique<bus::HealthReporter>(*participant.bus, *participant.node);
}

std::size_t VirtualTimeLoop::next_waiting(std::size_t from) const {
  return static_cast<std::size_t>(
      std::find(waiting_.begin() + static_cast<std::ptrdiff_t>(from), waiting_.end(), 1) -
      waiting_.begin());
}

// Repeatedly handles the participants that have messages, in the order of connection. The result is
// the same as if all participants were handled.
void VirtualTimeLoop::deliver() {
  while (waiting_count_ > 0) {
    for (std::size_t i = next_waiting(0); i < participants_.size() && waiting_count_ > 0;
         i = next_waiting(i + 1)) {
      waiting_[i] = 0;
      --waiting_count_;
      participants_[i].bus->handle(std::chrono::microseconds(0));
    }
    on_delivered_();
  }
  on_delivered_();
}

void VirtualTimeLoop::run_until(Time end) {
  deliver();
  while (true) {
    Time next = end;
    for (const Participant& participant : participants_) {
      if (participant.node != nullptr) {
        next = std::min(next, participant.node->next_tick());
      }
    }
    const Time now = std::max(next, clock_.now());
    clock_.set(std::min(now, end));
    if (now >= end) {
      return;
    }
    for (Participant& participant : participants_) {
      if (participant.node == nullptr || participant.node->next_tick() > now) {
        continue;
      }
      participant.node->tick(now);
      if (participant.node->next_tick() <= now) {
        throw std::logic_error(participant.node->name() +
                               ": next_tick() must be later than the present tick");
      }
      participant.health->on_loop(now, 0.0);
      deliver();
    }
  }
}

std::int64_t VirtualTimeLoop::messages_lost() const {
  std::int64_t lost = 0;
  for (const Participant& participant : participants_) {
    lost += participant.bus->messages_lost() + participant.transport->stats().queue_overflows;
  }
  return lost;
}

}  // namespace vantage::trial
