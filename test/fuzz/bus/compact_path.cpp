#include "test/fuzz/bus/compact_path.hpp"

#include <cstdio>
#include <cstdlib>

#include <Eigen/Cholesky>

#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "models/exchange/compact_belief.hpp"

namespace vantage::test {
namespace {

void promise_of_compact(bool is_kept, const char* what) {
  if (!is_kept) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

}  // namespace

void fuzz_compact_path(std::span<const std::uint8_t> input) {
  const auto wire = bus::decode_wire<vantage_lcm::compact_belief_t>(input);
  const auto message = wire ? bus::from_wire(*wire) : std::nullopt;
  if (!message) {
    return;
  }
  // Receivers refuse larger grids than their own before they expand a message.
  constexpr int kCellsExpanded = 20'000;
  if (message->grid.size() > kCellsExpanded) {
    return;
  }
  const auto belief = models::expand(*message);
  promise_of_compact(belief.has_value(), "an accepted message expands");
  int previous_id = -1;
  for (const models::TargetBelief& target : belief->targets) {
    const Eigen::LLT<models::StateMatrix> root(target.information.matrix);
    promise_of_compact(target.target_id > previous_id, "ids ascend");
    promise_of_compact(target.information.vector.allFinite() &&
                           target.information.matrix.allFinite() && root.info() == Eigen::Success,
                       "beliefs are finite and positive definite");
    promise_of_compact(target.last_seen <= belief->stamp.time, "no measurement of the future");
    previous_id = target.target_id;
  }
  for (const std::int64_t seen_utime : belief->last_seen_utime) {
    promise_of_compact(seen_utime >= 0 && seen_utime <= to_utime(belief->stamp.time),
                       "no cell seen in the future");
  }
}

std::vector<std::vector<std::uint8_t>> compact_path_samples() {
  std::vector<std::vector<std::uint8_t>> samples;
  for (int dim = models::kMinTargetDim; dim <= models::kMaxTargetDim; ++dim) {
    models::CompactBelief belief;
    belief.stamp = {from_utime(1'700'000'000'000'000), 1, 2};
    belief.robot = "Q1";
    for (int id = 0; id < dim; ++id) {
      models::StateMatrix covariance = models::StateMatrix::Constant(dim, dim, 0.3);
      covariance.diagonal().setConstant(1.0 + id);
      const models::Gaussian exact{models::StateVector::Constant(dim, 3.0 * id), covariance};
      const auto target = models::compact({id, *models::to_information(exact), belief.stamp.time},
                                          belief.stamp.time);
      belief.targets.push_back(*target);
    }
    belief.grid = {{-8.0, -8.0}, 1.0, 16, 16};
    if (dim % 2 == 0) {
      models::append_run(belief.runs, 3, 12, 0);
      models::append_run(belief.runs, 130, 7, 200);
    }
    const auto wire = bus::to_wire(belief);
    std::vector<std::uint8_t>& bytes = samples.emplace_back();
    bytes.resize(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  }
  return samples;
}

}  // namespace vantage::test
