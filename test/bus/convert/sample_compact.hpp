#pragma once

#include "models/exchange/compact_belief.hpp"
#include "test/bus/convert/sample_messages.hpp"

namespace vantage::test {

template <>
inline models::CompactBelief sample(Sampler& s) {
  auto belief = s.step_of<models::CompactBelief>();
  belief.stamp.time += from_seconds(1e6);  // later than the oldest cell
  for (int i = 0, id = 0; i < s.small(0, 6); ++i, id += s.small(1, 3)) {
    const int dim = s.small(2, 4);
    const models::Gaussian exact{s.vector(dim), s.definite(dim)};
    const Time last_seen = belief.stamp.time - Duration{s.whole(0, 1'000'000'000)};
    belief.targets.push_back(
        *models::compact({id, *models::to_information(exact), last_seen}, belief.stamp.time));
  }
  belief.grid = {{s.real(), s.real()}, s.real(0.1, 1.0), s.small(1, 9), s.small(1, 9)};
  for (int left = belief.grid.size(); left > 0;) {
    const int skip = s.small(0, left - 1);
    const int length = s.small(1, left - skip);
    models::append_run(belief.runs, skip, length, static_cast<std::uint8_t>(s.small(0, 255)));
    left -= skip + length;
  }
  return belief;
}

}  // namespace vantage::test
