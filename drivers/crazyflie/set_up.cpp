#include "drivers/crazyflie/set_up.hpp"

#include <utility>

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;
using crtp::Packet;

constexpr Duration kRepeat = std::chrono::milliseconds(100);
constexpr double kKalman = 2.0;
constexpr double kMellinger = 2.0;  // the PID controller (1) ignores velocities

}  // namespace

void CrazyflieSetUp::begin(const TableFetch& parameters, const TableFetch& logs,
                           bool writes_parameters, const std::optional<Pose3>& start) {
  *this = {};
  if (writes_parameters) {
    add_parameter(parameters, "stabilizer.estimator", kKalman);
    add_parameter(parameters, "stabilizer.controller", kMellinger);
    if (start) {
      add_parameter(parameters, "kalman.initialX", start->translation_m.x());
      add_parameter(parameters, "kalman.initialY", start->translation_m.y());
      add_parameter(parameters, "kalman.initialZ", start->translation_m.z());
      add_parameter(parameters, "kalman.initialYaw", flatten(*start).yaw_rad);
    }
    add_parameter(parameters, "kalman.resetEstimation", 1.0);
  }
  add_block(logs, kStateBlock);
  add_block(logs, kHealthBlock);
}

void CrazyflieSetUp::add_parameter(const TableFetch& table, const char* name, double value) {
  const crtp::TocItem* const item = table.find(name);
  const auto packet =
      item != nullptr ? crtp::parameter_write(item->id, item->type, value) : std::nullopt;
  if (!packet) {
    fault_ = std::string("the vehicle has no parameter ") + name + ": update its firmware";
    return;
  }
  steps_.push_back({*packet, name});
}

void CrazyflieSetUp::add_block(const TableFetch& table, std::uint8_t block) {
  std::vector<crtp::LogVariable> variables;
  for (const LoggedVariable& wanted : logged_variables(block)) {
    const crtp::TocItem* const item = table.find(wanted.name);
    if (item != nullptr) {
      variables.push_back({item->id, wanted.type});
      has_battery_ = has_battery_ || wanted.is_optional;
    } else if (!wanted.is_optional) {
      fault_ =
          std::string("the vehicle has no log variable ") + wanted.name + ": update its firmware";
      return;
    }
  }
  const auto create = crtp::log_create(block, variables);
  if (!create) {
    fault_ = "log block " + std::to_string(block) + " is too large";
    return;
  }
  // A block of an earlier driver is stopped before it is deleted: deleting a running block makes
  // the firmware read freed memory.
  steps_.push_back({crtp::log_stop(block), ""});
  steps_.push_back({crtp::log_delete(block), ""});
  steps_.push_back({*create, "log block"});
  steps_.push_back({crtp::log_start(block, kLogPeriodMs), "log block"});
}

void CrazyflieSetUp::receive(const Packet& packet) {
  if (fault_ || done_ >= steps_.size()) {
    return;
  }
  const Step& step = steps_[done_];
  if (step.request.port == crtp::Port::kParameter) {
    const auto id = crtp::parameter_reply_id(packet);
    if (packet.channel != 2 || !id || *id != crtp::parameter_reply_id(step.request)) {
      return;
    }
    if (packet == step.request) {
      finish_step();
    } else {
      fault_ = "the vehicle refused to set the parameter " + step.name;
    }
    return;
  }
  const auto reply = crtp::decode_log_reply(packet);
  if (!reply || reply->command != step.request.data[0] || reply->block != step.request.data[1]) {
    return;
  }
  const bool is_removal = reply->command == crtp::kLogStop || reply->command == crtp::kLogDelete;
  const bool is_there = reply->command == crtp::kLogCreate && reply->error == crtp::kLogExists;
  if (reply->error == crtp::kLogOk || is_removal || is_there) {
    finish_step();
  } else {
    fault_ = "the vehicle refused a " + step.name + ": error " + std::to_string(reply->error);
  }
}

std::optional<Packet> CrazyflieSetUp::tick(Time now) {
  if (fault_ || done_ >= steps_.size() || now < next_) {
    return std::nullopt;
  }
  next_ = now + kRepeat;
  return steps_[done_].request;
}

}  // namespace vantage::drivers
