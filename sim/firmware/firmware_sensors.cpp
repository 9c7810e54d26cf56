#include "sim/firmware/firmware_sensors.hpp"

#include <cmath>

#include "core/axes.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

// gauss; magnetic field at the origin that the driver sends to autopilots (on the north-east coast
// of America).
const Eigen::Vector3d kFieldNedGauss(0.205, -0.042, 0.470);
constexpr double kOriginAltitudeM = 10.0;
constexpr double kSeaLevelHpa = 1013.25;
constexpr double kSeaLevelK = 288.15;
constexpr double kLapseKpm = 0.0065;
constexpr double kExponent = 5.2559;

}  // namespace

SensorBoard::SensorBoard(const SensorNoise& noise, std::uint64_t seed)
    : noise_(noise), rng_(random_stream(seed, "sensor board")) {
  gyro_bias_radps_ = draw(noise_.gyro_bias_sigma_radps);
  accelerometer_bias_mps2_ = draw(noise_.accelerometer_bias_sigma_mps2);
}

Eigen::Vector3d SensorBoard::draw(double sigma) {
  const double x = normal_(rng_);
  const double y = normal_(rng_);
  const double z = normal_(rng_);
  return sigma * Eigen::Vector3d(x, y, z);
}

FirmwareSensors SensorBoard::sample(const Multirotor& body, Duration since_start) {
  FirmwareSensors out;
  out.since_start = since_start;
  out.local_from_body = convert_axes(body.world_from_body().rotation);
  out.position_local_m = convert_axes(body.world_from_body().translation_m);
  out.velocity_local_mps = convert_axes(body.velocity_world_mps());
  out.gyro_body_radps =
      convert_axes(body.rate_body_radps()) + gyro_bias_radps_ + draw(noise_.gyro_sigma_radps);
  out.specific_force_body_mps2 = convert_axes(body.specific_force_body_mps2()) +
                                 accelerometer_bias_mps2_ + draw(noise_.accelerometer_sigma_mps2);
  out.magnetic_field_body_gauss =
      out.local_from_body.conjugate() * kFieldNedGauss + draw(noise_.magnetometer_sigma_gauss);
  const double height_m = body.world_from_body().translation_m.z();
  out.pressure_altitude_m = kOriginAltitudeM + height_m + noise_.barometer_sigma_m * normal_(rng_);
  out.pressure_hpa =
      kSeaLevelHpa * std::pow(1.0 - kLapseKpm * out.pressure_altitude_m / kSeaLevelK, kExponent);
  out.battery_v = body.battery_v();
  out.battery_a = body.battery_a();
  out.battery_share = body.battery_share();
  return out;
}

}  // namespace vantage::sim
