#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace vantage::models {

struct SensorLaw;

/// Sensor kind: a handle to its SensorLaw, compared by identity. Custom kinds are made from a
/// SensorLaw that must outlive them.
class SensorKind {
 public:
  constexpr explicit SensorKind(const SensorLaw& law) : law_(&law) {}
  [[nodiscard]] constexpr const SensorLaw& law() const { return *law_; }
  /// Returns its name in scenario files, for example "range_bearing".
  [[nodiscard]] std::string_view name() const;

  friend constexpr bool operator==(SensorKind a, SensorKind b) { return a.law_ == b.law_; }

  static const SensorKind kPosition;
  static const SensorKind kRange;
  static const SensorKind kBearing;
  static const SensorKind kRangeBearing;
  static const SensorKind kCamera;

 private:
  const SensorLaw* law_;
};

/// Returns every kind that scenarios may name, in the order of error messages. To add a kind, add a
/// file in models/sensor/kinds and its line in kinds.cpp.
std::span<const SensorKind> all_sensor_kinds();
/// Returns the kind with that scenario name; nullopt if unknown.
std::optional<SensorKind> sensor_kind_called(std::string_view name);

}  // namespace vantage::models
