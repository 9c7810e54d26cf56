#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "core/time.hpp"
#include "models/exchange/attack_timeout.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Newest attack notice, which states whether a robot's sensor is jammed.
class JamWatch {
 public:
  void on_notice(const models::AttackNotice& notice, Time now) {
    notice_ = notice;
    received_at_ = now;
  }
  /// Returns the notice that jams `robot`; null: the sensor is not jammed.
  [[nodiscard]] const models::AttackNotice* notice_for(const std::string& robot, Time now) {
    if (notice_ && now - received_at_ > models::kAttackTimeout) {
      notice_.reset();
    }
    const bool is_jammed = notice_ && std::find(notice_->jammed.begin(), notice_->jammed.end(),
                                                robot) != notice_->jammed.end();
    return is_jammed ? &*notice_ : nullptr;
  }

 private:
  std::optional<models::AttackNotice> notice_;
  Time received_at_{};
};

}  // namespace vantage::drivers
