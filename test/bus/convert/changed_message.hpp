#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"

/// A function that returns the field `member` of a wire message.
#define VANTAGE_FIELD(member) \
  [](auto& w) -> auto& { return w.member; }

namespace vantage::test {

/// A valid message and functions that change one field and check whether the decoder accepts the
/// result.
template <class Message>
class Changed {
 public:
  explicit Changed(const Message& message) : good_(bus::to_wire(message)) {
    EXPECT_TRUE(bus::from_wire(good_).has_value());
  }
  void taken(const char* what, const std::function<void(bus::WireOf<Message>&)>& change) const {
    EXPECT_TRUE(is_taken(change)) << what;
  }
  void refused(const char* what, const std::function<void(bus::WireOf<Message>&)>& change) const {
    EXPECT_FALSE(is_taken(change)) << what;
  }
  /// Checks that the number given by `member` is accepted from `min` to `max` and rejected outside.
  template <class Member>
  void between(const char* what, double min, double max, const Member& member) const {
    for (const double good : {min, 0.5 * (min + max), max}) {
      EXPECT_TRUE(is_taken([&](auto& w) { member(w) = good; })) << what << ' ' << good;
    }
    const double beside = 1e-9 * std::max(1.0, max - min);
    for (const double bad : {min - beside, max + beside, kNan, kInfinity, -kInfinity}) {
      EXPECT_FALSE(is_taken([&](auto& w) { member(w) = bad; })) << what << ' ' << bad;
    }
  }
  /// Checks that `member` may be any finite number.
  template <class Member>
  void finite(const char* what, const Member& member) const {
    for (const double good : {-kMax, -1e9, 0.0, 1e9, kMax}) {
      EXPECT_TRUE(is_taken([&](auto& w) { member(w) = good; })) << what << ' ' << good;
    }
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      EXPECT_FALSE(is_taken([&](auto& w) { member(w) = bad; })) << what << ' ' << bad;
    }
  }
  /// Checks that `member` may be any finite number that is not negative.
  template <class Member>
  void amount(const char* what, const Member& member) const {
    for (const double good : {0.0, 1e9, kMax}) {
      EXPECT_TRUE(is_taken([&](auto& w) { member(w) = good; })) << what << ' ' << good;
    }
    for (const double bad : {-1e-9, kNan, kInfinity, -kInfinity}) {
      EXPECT_FALSE(is_taken([&](auto& w) { member(w) = bad; })) << what << ' ' << bad;
    }
  }
  /// Checks that the integer `member` is accepted from `min` to `max` (if given) and rejected
  /// outside.
  template <class Member>
  void whole(const char* what, std::int64_t min, const Member& member,
             std::optional<std::int64_t> max = std::nullopt) const {
    const auto with = [&](std::int64_t value) {
      return is_taken([&](auto& w) {
        auto& place = member(w);
        place = static_cast<std::remove_reference_t<decltype(place)>>(value);
      });
    };
    EXPECT_TRUE(with(min) && with(max.value_or(2'000'000'000))) << what;
    EXPECT_FALSE(with(min - 1)) << what;
    EXPECT_TRUE(!max || !with(*max + 1)) << what;
  }
  template <class Member>
  void utime(const char* what, const Member& member) const {
    whole(what, -kLatestUtime, member, kLatestUtime);
  }
  template <class Member>
  void text(const char* what, const Member& member) const {
    EXPECT_TRUE(is_taken([&](auto& w) { member(w).assign(256, 'x'); })) << what;
    EXPECT_FALSE(is_taken([&](auto& w) { member(w).assign(257, 'x'); })) << what;
    EXPECT_FALSE(is_taken([&](auto& w) { member(w) = "\xC3("; })) << what << ", not UTF-8";
  }
  template <class Member>
  void boolean(const char* what, const Member& member) const {
    whole(what, 0, member, 1);
  }
  /// Checks that `member` must equal the number of elements.
  template <class Member>
  void count(const char* what, const Member& member) const {
    EXPECT_FALSE(is_taken([&](auto& w) { ++member(w); })) << what;
    EXPECT_FALSE(is_taken([&](auto& w) { --member(w); })) << what;
  }

 private:
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr double kMax = std::numeric_limits<double>::max();
  /// µs since 1970: in the year 2286.
  static constexpr std::int64_t kLatestUtime = 10'000'000'000'000'000;

  [[nodiscard]] bool is_taken(const std::function<void(bus::WireOf<Message>&)>& change) const {
    bus::WireOf<Message> changed = good_;
    change(changed);
    return bus::from_wire(changed).has_value();
  }
  bus::WireOf<Message> good_;
};

}  // namespace vantage::test
