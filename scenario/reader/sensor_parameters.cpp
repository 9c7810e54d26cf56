#include "scenario/reader/sensor_parameters.hpp"

#include <string>

#include <fmt/format.h>

#include "core/index.hpp"
#include "models/sensor/law.hpp"

namespace vantage::scenario {
namespace {

Range range_of(models::ParameterRule rule) {
  return rule == models::ParameterRule::kAny           ? any_number()
         : rule == models::ParameterRule::kAtLeastZero ? at_least(0.0)
                                                       : above(0.0);
}

std::string own_parameters_of(models::SensorKind kind) {
  std::string names;
  for (const models::SensorParameter& each : kind.law().parameters) {
    names += fmt::format("{}{}, {} (default {:g})", names.empty() ? "" : "; ", each.name,
                         each.purpose, each.initial);
  }
  return names.empty() ? "none" : names;
}

}  // namespace

void read_own_parameters(Mapping& from, models::SensorModel& sensor) {
  for (const models::SensorKind kind : models::all_sensor_kinds()) {
    for (const models::SensorParameter& each : kind.law().parameters) {
      const std::optional<int> i = models::find_parameter(sensor.kind, each.name);
      double value = i ? models::own_parameter(sensor, *i) : each.initial;
      from.number(each.name, value, range_of(each.rule));
      if (i) {
        sensor.own[index(*i)] = value;
      } else if (from.find(each.name)) {
        from.refuse(each.name,
                    fmt::format("is a parameter of sensor kind {}; kind {} has its own parameters: "
                                "{}",
                                kind.name(), sensor.kind.name(), own_parameters_of(sensor.kind)));
      }
    }
  }
}

}  // namespace vantage::scenario
