#include "models/exchange/compact_belief.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <Eigen/Cholesky>

#include "core/index.hpp"

namespace vantage::models {
namespace {

constexpr double kCodesPerOctave = 1024.0;
constexpr double kCorrelationScale = 32'767.0;
constexpr double kLn2 = 0.693147180559945309417;
/// Share of a variance that covers the rounding of the correlations: each row has at most three
/// errors of half a unit, and the matrix of errors plus this diagonal is diagonally dominant. The
/// term 1e-9 covers the rounding of double arithmetic.
constexpr double kRoundingShare = 3.0 * 0.5 / kCorrelationScale + 1e-9;

constexpr std::int64_t kLinearUs = 500'000;  // µs per code
constexpr int kLinearCodes = 128;
constexpr double kCodesPerDoubling = 16.0;

double sigma_of(std::int16_t code) { return std::exp(code / kCodesPerOctave * kLn2); }

/// Returns the smallest code with σ ≥ `sigma` > 0; nullopt out of range.
std::optional<std::int16_t> sigma_code(double sigma) {
  const double exact = std::ceil(std::log(sigma) / kLn2 * kCodesPerOctave);
  constexpr double kMin = std::numeric_limits<std::int16_t>::min();
  constexpr double kMax = std::numeric_limits<std::int16_t>::max();
  if (!(exact >= kMin && exact < kMax)) {
    return std::nullopt;
  }
  const auto code = static_cast<std::int16_t>(exact);
  return sigma_of(code) >= sigma ? code : static_cast<std::int16_t>(code + 1);
}

std::array<Duration, 256> make_cell_ages() {
  std::array<Duration, 256> ages{};
  for (std::size_t code = 0; code < ages.size(); ++code) {
    const double doublings =
        std::max(0.0, (static_cast<double>(code) - kLinearCodes) / kCodesPerDoubling);
    const std::int64_t linear_us =
        kLinearUs * static_cast<std::int64_t>(std::min<std::size_t>(code, kLinearCodes));
    // All ages are multiples of 0.5 s, so relaying a recent stamp does not round it again.
    const double steps = std::round(static_cast<double>(linear_us) /
                                    static_cast<double>(kLinearUs) * std::exp(doublings * kLn2));
    ages[code] = Duration{static_cast<std::int64_t>(steps) * kLinearUs};
  }
  return ages;
}

const std::array<Duration, 256>& cell_ages() {
  static const std::array<Duration, 256> kAges = make_cell_ages();
  return kAges;
}

void append_number(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
  constexpr std::uint32_t kMore = 0x80;
  for (; number >= kMore; number >>= 7U) {
    bytes.push_back(static_cast<std::uint8_t>(number | kMore));
  }
  bytes.push_back(static_cast<std::uint8_t>(number));
}

/// Removes a number from the beginning of `bytes`; nullopt if it is incomplete or has more than 28
/// bits.
std::optional<int> take_number(std::span<const std::uint8_t>& bytes) {
  constexpr std::size_t kBytesMax = 4;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < std::min(kBytesMax, bytes.size()); ++i) {
    number |= (bytes[i] & 0x7FU) << (7U * static_cast<unsigned>(i));
    if ((bytes[i] & 0x80U) == 0) {
      bytes = bytes.subspan(i + 1);
      return static_cast<int>(number);
    }
  }
  return std::nullopt;
}

/// Calls `put(cell, length, seen_utime)` for each run. Returns false if the runs are malformed.
template <class Put>
bool read_runs(std::span<const std::uint8_t> runs, std::int64_t now_utime, std::int64_t cells,
               const Put& put) {
  std::int64_t cell = 0;
  while (!runs.empty()) {
    const auto skip = take_number(runs);
    const auto length = skip ? take_number(runs) : std::nullopt;
    if (!length || *length == 0 || runs.empty() || cell + *skip + *length > cells) {
      return false;
    }
    const std::int64_t seen_utime = now_utime - cell_age(runs.front()).count();
    if (seen_utime <= VisibilityGrid::kNeverSeen) {
      return false;
    }
    runs = runs.subspan(1);
    cell += *skip;
    put(cell, *length, seen_utime);
    cell += *length;
  }
  return true;
}

Time last_seen(const CompactBelief& belief, const CompactTarget& target) {
  return belief.stamp.time - Duration{std::int64_t{target.unseen_ms} * 1000};
}

}  // namespace

std::optional<CompactTarget> compact(const TargetBelief& belief, Time at) {
  const auto exact = to_gaussian(belief.information);
  const std::int64_t unseen_us = std::max<std::int64_t>(0, (at - belief.last_seen).count());
  const std::int64_t unseen_ms = (unseen_us + 999) / 1000;
  if (!exact || unseen_ms > std::numeric_limits<std::int32_t>::max()) {
    return std::nullopt;
  }
  CompactTarget out;
  out.target_id = belief.target_id;
  out.dim = static_cast<int>(exact->mean.size());
  out.unseen_ms = static_cast<std::int32_t>(unseen_ms);
  StateVector shift = exact->mean;
  for (int i = 0; i < out.dim; ++i) {
    out.mean[index(i)] = static_cast<float>(exact->mean(i));
    shift(i) -= static_cast<double>(out.mean[index(i)]);
  }
  // The second moment about the rounded mean.
  const StateMatrix moment = exact->covariance + shift * shift.transpose();
  StateVector sigma = shift;
  for (int i = 0; i < out.dim; ++i) {
    const auto code = sigma_code(std::sqrt(moment(i, i) / (1.0 - kRoundingShare)));
    if (!code) {
      return std::nullopt;
    }
    out.sigma_code[index(i)] = *code;
    sigma(i) = sigma_of(*code);
  }
  int entry = 0;
  for (int i = 0; i < out.dim; ++i) {
    for (int j = 0; j < i; ++j) {
      const double correlation = moment(i, j) / (sigma(i) * sigma(j));
      out.correlation_code[index(entry++)] =
          static_cast<std::int16_t>(std::lround(correlation * kCorrelationScale));
    }
  }
  return expand(out) ? std::optional(out) : std::nullopt;
}

std::optional<Gaussian> expand(const CompactTarget& target) {
  constexpr int kCodeMax = 32'767;
  if (target.dim < kMinTargetDim || target.dim > kMaxTargetDim || target.unseen_ms < 0) {
    return std::nullopt;
  }
  Gaussian out{StateVector::Zero(target.dim), StateMatrix::Identity(target.dim, target.dim)};
  StateMatrix& C = out.covariance;
  int entry = 0;
  for (int i = 0; i < target.dim; ++i) {
    out.mean(i) = static_cast<double>(target.mean[index(i)]);
    for (int j = 0; j < i; ++j) {
      const int code = target.correlation_code[index(entry++)];
      if (code < -kCodeMax) {
        return std::nullopt;
      }
      C(i, j) = C(j, i) = code / kCorrelationScale;
    }
  }
  const Eigen::LLT<StateMatrix> root(C);
  if (!out.mean.allFinite() || root.info() != Eigen::Success) {
    return std::nullopt;
  }
  for (int i = 0; i < target.dim; ++i) {
    const double sigma = sigma_of(target.sigma_code[index(i)]);
    C.row(i) *= sigma;
    C.col(i) *= sigma;
  }
  return to_information(out) ? std::optional(out) : std::nullopt;
}

Duration cell_age_max() { return cell_ages().back(); }

std::optional<std::uint8_t> cell_age_code(Duration age) {
  const auto& ages = cell_ages();
  const auto found = std::lower_bound(ages.begin(), ages.end(), age);
  return age < Duration{} || found == ages.end()
             ? std::nullopt
             : std::optional(static_cast<std::uint8_t>(found - ages.begin()));
}

Duration cell_age(std::uint8_t code) { return cell_ages()[code]; }

void append_run(std::vector<std::uint8_t>& runs, int skip, int length, std::uint8_t age_code) {
  append_number(runs, static_cast<std::uint32_t>(skip));
  append_number(runs, static_cast<std::uint32_t>(length));
  runs.push_back(age_code);
}

bool is_valid(const CompactBelief& compact) {
  int previous_id = -1;
  for (const CompactTarget& each : compact.targets) {
    if (each.target_id <= previous_id || to_utime(last_seen(compact, each)) < 0 || !expand(each)) {
      return false;
    }
    previous_id = each.target_id;
  }
  return read_runs(compact.runs, to_utime(compact.stamp.time), compact.grid.size(), [](auto...) {});
}

std::optional<RobotBelief> expand(const CompactBelief& compact) {
  if (!is_valid(compact)) {
    return std::nullopt;
  }
  RobotBelief out;
  out.stamp = compact.stamp;
  out.robot = compact.robot;
  out.step = compact.step;
  out.viewpoint = compact.viewpoint;
  out.targets.reserve(compact.targets.size());
  for (const CompactTarget& each : compact.targets) {
    const auto belief = expand(each);
    const auto information = belief ? to_information(*belief) : std::nullopt;
    if (!information) {
      return std::nullopt;
    }
    out.targets.push_back({each.target_id, *information, last_seen(compact, each)});
  }
  out.grid = compact.grid;
  if (!compact.runs.empty()) {
    std::vector<std::int64_t>& stamps = out.last_seen_utime;
    stamps.assign(index(compact.grid.size()), VisibilityGrid::kNeverSeen);
    read_runs(compact.runs, to_utime(compact.stamp.time), compact.grid.size(),
              [&](std::int64_t cell, int length, std::int64_t seen_utime) {
                std::fill_n(stamps.begin() + cell, length, seen_utime);
              });
  }
  return out;
}

}  // namespace vantage::models
