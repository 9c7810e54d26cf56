#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace vantage::models {

struct SensorLaw;

/// Which kind of sensor it is: a handle on its law, compared by identity. Kinds that are not ours
/// are made of a SensorLaw of one's own, which must outlive them.
class SensorKind {
 public:
  constexpr explicit SensorKind(const SensorLaw& law) : law_(&law) {}
  [[nodiscard]] constexpr const SensorLaw& law() const { return *law_; }
  /// Its word in scenarios: "range_bearing".
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

/// Every kind that scenarios may name, in the order in which people are told. A new one is a file
/// in models/sensor/kinds and its line in kinds.cpp.
std::span<const SensorKind> all_sensor_kinds();
/// The one of that word.
std::optional<SensorKind> sensor_kind_called(std::string_view name);

}  // namespace vantage::models
