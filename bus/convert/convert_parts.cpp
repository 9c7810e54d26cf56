#include "bus/convert/convert_parts.hpp"

#include <cmath>
#include <limits>
#include <string_view>

#include <Eigen/Cholesky>

#include "core/index.hpp"
#include "core/utf8.hpp"

namespace vantage::bus::parts {
bool is_utime(std::int64_t utime) { return utime >= -kUtimeMax && utime <= kUtimeMax; }

bool is_text(const std::string& text, std::size_t bytes_max) {
  return text.size() <= bytes_max && is_utf8(text);
}

std::string to_wire_text(std::string text) {
  constexpr std::string_view kMore = "…";
  if (!is_utf8(text)) {
    text = readable(text);
  }
  if (text.size() > kTextBytesMax) {
    text.resize(kTextBytesMax - kMore.size());
    while (!is_utf8(text)) {
      text.pop_back();  // removes an incomplete character at the end
    }
    text += kMore;
  }
  return text;
}

bool is_count(std::int64_t count, std::size_t elements, std::size_t cap) {
  return count >= 0 && static_cast<std::uint64_t>(count) == elements && elements <= cap;
}

std::optional<Pose2> pose2_from(double x_m, double y_m, double yaw_rad) {
  if (!are_finite(x_m, y_m, yaw_rad)) {
    return std::nullopt;
  }
  return Pose2{x_m, y_m, wrap_to_pi(yaw_rad)};  // unchanged for an angle in (−π, π]
}

std::optional<Pose3> pose3_from(const double (&position_m)[3], const double (&quaternion_wxyz)[4]) {
  const Eigen::Vector3d position(position_m[0], position_m[1], position_m[2]);
  Quaternion rotation(quaternion_wxyz[0], quaternion_wxyz[1], quaternion_wxyz[2],
                      quaternion_wxyz[3]);
  const double norm = rotation.norm();
  // Also rejects a NaN norm.
  if (!position.allFinite() || !(std::abs(norm - 1.0) <= kQuaternionNormErrorMax)) {
    return std::nullopt;
  }
  // A quaternion of unit norm up to rounding is not normalised again, so that a replayed log gives
  // the same bits.
  constexpr double kRounding = 1e-12;
  if (std::abs(norm - 1.0) > kRounding) {
    rotation.normalize();
  }
  return Pose3{position, rotation};
}

void pose3_to(const Pose3& pose, double (&position_m)[3], double (&quaternion_wxyz)[4]) {
  for (int i = 0; i < 3; ++i) {
    position_m[i] = pose.translation_m(i);
  }
  quaternion_wxyz[0] = pose.rotation.w();
  quaternion_wxyz[1] = pose.rotation.x();
  quaternion_wxyz[2] = pose.rotation.y();
  quaternion_wxyz[3] = pose.rotation.z();
}

std::optional<SmallMatrix> definite_from(const Rows& rows, int dim) {
  if (dim < 1 || dim > 4 || !is_count(dim, rows.size())) {
    return std::nullopt;
  }
  SmallMatrix M(dim, dim);
  for (int i = 0; i < dim; ++i) {
    const std::vector<double>& row = rows[index(i)];
    if (!is_count(dim, row.size())) {
      return std::nullopt;
    }
    for (int j = 0; j < dim; ++j) {
      M(i, j) = row[index(j)];
    }
  }
  const double largest = M.cwiseAbs().maxCoeff();
  if (!M.allFinite() || (M - M.transpose()).cwiseAbs().maxCoeff() > kAsymmetryMax * largest) {
    return std::nullopt;
  }
  const Eigen::LLT<SmallMatrix> cholesky(M);
  // LLT does not report a NaN pivot (infinity minus infinity).
  if (cholesky.info() != Eigen::Success || !cholesky.matrixLLT().allFinite()) {
    return std::nullopt;
  }
  return M;
}

Rows rows_to(const SmallMatrix& M, int dim) {
  const auto side = static_cast<std::size_t>(dim);
  Rows rows(side, std::vector<double>(side, std::numeric_limits<double>::quiet_NaN()));
  for (int i = 0; i < dim && i < M.rows(); ++i) {
    for (int j = 0; j < dim && j < M.cols(); ++j) {
      rows[index(i)][index(j)] = M(i, j);
    }
  }
  return rows;
}

std::optional<std::vector<models::InputRef>> inputs_from(
    std::int32_t count, const std::vector<vantage_lcm::input_ref_t>& wire) {
  if (!is_count(count, wire.size())) {
    return std::nullopt;
  }
  std::vector<models::InputRef> inputs;
  inputs.reserve(wire.size());
  for (const vantage_lcm::input_ref_t& ref : wire) {
    if (!is_text(ref.channel) || ref.sequence < 0) {
      return std::nullopt;
    }
    inputs.push_back({ref.channel, ref.run_id, ref.sequence});
  }
  return inputs;
}

std::vector<vantage_lcm::input_ref_t> inputs_to(const std::vector<models::InputRef>& inputs) {
  std::vector<vantage_lcm::input_ref_t> wire(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    wire[i].channel = inputs[i].channel;
    wire[i].run_id = inputs[i].run_id;
    wire[i].sequence = inputs[i].sequence;
  }
  return wire;
}

}  // namespace vantage::bus::parts
