#include <algorithm>

#include "test/drivers/safety/fault_catalogue.hpp"
#include "test/drivers/safety/setpoint_monitor.hpp"

namespace vantage::test {
namespace {

bool is_concerned(const Fault& fault, const Vehicle& vehicle) {
  const std::string vehicles = fault.vehicles;
  return vehicles == "all" || vehicles.find(vehicle.name) != std::string::npos;
}

bool shows(const Vehicle& vehicle, const std::string& reason) {
  const auto rows = drivers::conditions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (vehicle.out.reasons[i] && rows[i].name == reason) {
      return true;
    }
  }
  return false;
}

// Observes one fault during a run.
class FaultObserver {
 public:
  FaultObserver(const Fault& fault, FlightBench& bench) : fault_(fault) {
    outcome_.stage_s.assign(fault.stages.size(), -1.0);
    outcome_.end = models::FlightState::kKilled;
    for (const Vehicle& vehicle : bench.vehicles()) {
      before_.push_back(fault.counter != nullptr ? bench.count_of(vehicle, fault.counter) : 0);
    }
    reasons_of_.assign(bench.vehicles().size(), false);
  }

  void observe(FlightBench& bench, double since_s) {
    const double after_s = since_s - fault_.begins_s;
    if (after_s < -1e-9) {
      return;
    }
    int least = 3;
    bool all_reacted = true;
    for (std::size_t i = 0; i < bench.vehicles().size(); ++i) {
      const Vehicle& vehicle = bench.vehicles()[i];
      if (!is_concerned(fault_, vehicle)) {
        continue;
      }
      least = std::min(least, severity_of(vehicle.out.state));
      if (fault_.reason != nullptr) {
        reasons_of_[i] = reasons_of_[i] || shows(vehicle, fault_.reason);
      } else if (fault_.counter != nullptr) {
        reasons_of_[i] = reasons_of_[i] || bench.count_of(vehicle, fault_.counter) > before_[i];
      } else {
        reasons_of_[i] = fault_.stages.empty() || severity_of(vehicle.out.state) > 0;
      }
      all_reacted = all_reacted && reasons_of_[i];
      remember_reasons(vehicle);
    }
    if (all_reacted && !outcome_.reacted) {
      outcome_.reacted = true;
      outcome_.reaction_s = after_s;
    }
    for (std::size_t i = 0; i < fault_.stages.size(); ++i) {
      if (outcome_.stage_s[i] < 0.0 && least >= severity_of(fault_.stages[i].state)) {
        outcome_.stage_s[i] = after_s;
      }
    }
  }

  Outcome finish(FlightBench& bench) {
    int least = 4;
    for (const Vehicle& vehicle : bench.vehicles()) {
      if (is_concerned(fault_, vehicle) && severity_of(vehicle.out.state) < least) {
        least = severity_of(vehicle.out.state);
        outcome_.end = vehicle.out.state;
      }
    }
    return outcome_;
  }

 private:
  void remember_reasons(const Vehicle& vehicle) {
    const auto rows = drivers::conditions();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      auto& seen = outcome_.reasons;
      if (vehicle.out.reasons[i] &&
          std::find(seen.begin(), seen.end(), rows[i].name) == seen.end()) {
        seen.emplace_back(rows[i].name);
      }
    }
  }

  const Fault& fault_;
  Outcome outcome_;
  std::vector<std::int64_t> before_;
  std::vector<bool> reasons_of_;
};

}  // namespace

FaultRun fly(FlightBench& bench, std::span<const Fault* const> faults, double lasts_s,
             SetpointMonitor* monitor) {
  std::vector<FaultObserver> observers;
  for (const Fault* fault : faults) {
    observers.emplace_back(*fault, bench);
  }
  const auto ticks = static_cast<int>(lasts_s / FlightBench::kTickS);
  for (int i = 0; i < ticks; ++i) {
    const auto since_s = [i](std::size_t k) {
      return i * FlightBench::kTickS - static_cast<double>(k) * kStaggerS;
    };
    for (std::size_t k = 0; k < faults.size(); ++k) {
      if (since_s(k) > -1e-9) {
        faults[k]->act(bench, since_s(k));
      }
    }
    bench.tick();
    if (monitor != nullptr) {
      monitor->update(bench);
    }
    for (std::size_t k = 0; k < faults.size(); ++k) {
      observers[k].observe(bench, since_s(k));
    }
  }
  FaultRun run;
  for (FaultObserver& observer : observers) {
    run.outcomes.push_back(observer.finish(bench));
  }
  run.violations = bench.violations();
  run.closest_m = bench.closest_m();
  return run;
}

FaultRun fly_with(std::span<const Fault* const> faults, std::uint64_t seed, double lasts_s) {
  const bool trusts_plans = std::any_of(faults.begin(), faults.end(),
                                        [](const Fault* fault) { return fault->trusts_plans; });
  FlightBench bench(seed, trusts_plans);
  bench.fly_up(kBeginS);
  SetpointMonitor monitor(bench);
  FaultRun run = fly(bench, faults, lasts_s, &monitor);
  run.path_violations = monitor.path_violations();
  return run;
}

}  // namespace vantage::test
