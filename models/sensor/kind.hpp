#pragma once

#include <span>
#include <string_view>

namespace vantage::models {

struct SensorLaw;

/// A kind of sensor: a pointer to its measurement model (SensorLaw). Two kinds are equal if they
/// point to the same model.
/// User-defined kinds are made from a SensorLaw, which must outlive them.
class SensorKind {
 public:
  constexpr explicit SensorKind(const SensorLaw& law) : law_(&law) {}
  [[nodiscard]] constexpr const SensorLaw& law() const { return *law_; }
  /// Returns the name used in scenarios, such as "range_bearing".
  [[nodiscard]] std::string_view name() const;

  friend constexpr bool operator==(SensorKind a, SensorKind b) { return a.law_ == b.law_; }

  static const SensorKind kPosition;
  static const SensorKind kRange;
  static const SensorKind kBearing;
  static const SensorKind kRangeBearing;
  static const SensorKind kCamera;
  static const SensorKind kRangeRate;

 private:
  const SensorLaw* law_;
};

/// Returns all kinds that scenarios may name, in display order. A new kind needs a file in
/// models/sensor/kinds and a line in kinds.cpp.
std::span<const SensorKind> all_sensor_kinds();

}  // namespace vantage::models
