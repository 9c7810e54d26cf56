#include "planner/search/cost_order.hpp"

#include <bit>

#include "core/index.hpp"

namespace vantage::planner {

CostOrder::CostOrder(std::size_t entries_max) : entries_(entries_max), other_(entries_max) {}

void CostOrder::prefault() {
  entries_.prefault();
  other_.prefault();
}

void CostOrder::clear() {
  count_ = 0;
  next_ = 0;
}

std::uint64_t CostOrder::key_of(double cost) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  const auto bits = std::bit_cast<std::uint64_t>(cost + 0.0);  // −0 becomes 0
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

void CostOrder::sort_few() {  // std::stable_sort would allocate
  for (std::size_t i = 0; i < count_; ++i) {
    other_[i] = {entries_[i].key, static_cast<NodeId>(i)};
  }
  std::sort(other_.begin(), other_.begin() + count_, [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.id < b.id;
  });
  for (std::size_t i = 0; i < count_; ++i) {
    other_[i].id = entries_[other_[i].id].id;
  }
  std::swap(entries_, other_);
}

void CostOrder::count_digits(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    for (int digit = 0; digit < kDigits; ++digit) {
      ++places_[index(digit)][digit_of(entries_[i].key, digit)];
    }
  }
}

bool CostOrder::place(int digit) {
  auto& places = places_[index(digit)];
  if (places[digit_of(entries_[0].key, digit)] == count_) {
    return false;
  }
  std::uint32_t before = 0;
  for (std::uint32_t& place : places) {
    const std::uint32_t here = place;
    place = before;
    before += here;
  }
  return true;
}

void CostOrder::scatter(int digit, std::size_t begin, std::size_t end) {
  auto& places = places_[index(digit)];
  for (std::size_t i = begin; i < end; ++i) {
    other_[places[digit_of(entries_[i].key, digit)]++] = entries_[i];
  }
}

}  // namespace vantage::planner
