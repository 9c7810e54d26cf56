#include "tools/console/order_receipts.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using models::FlightState;
using models::OperatorAction;
using Outcome = OrderReceipts::Outcome;

constexpr Time kStart = from_utime(1'000'000);

models::VehicleStatus status_of(FlightState state, std::vector<std::string> reasons = {}) {
  models::VehicleStatus out;
  out.robot = "Q1";
  out.state = state;
  out.reasons = std::move(reasons);
  return out;
}

TEST(OrderReceipts, AreDecidedByTheVehiclesStatus) {
  struct Row {
    OperatorAction action;
    FlightState state;
    std::vector<std::string> reasons;
    Outcome outcome;
  };
  const std::vector<Row> rows = {
      {OperatorAction::kEmergencyStop, FlightState::kKilled, {}, Outcome::kConfirmed},
      {OperatorAction::kEmergencyStop, FlightState::kFollow, {}, Outcome::kAwaited},
      {OperatorAction::kEmergencyStop, FlightState::kLand, {}, Outcome::kAwaited},
      {OperatorAction::kLand, FlightState::kLand, {}, Outcome::kConfirmed},
      {OperatorAction::kLand, FlightState::kHold, {}, Outcome::kAwaited},
      {OperatorAction::kHold, FlightState::kHold, {}, Outcome::kConfirmed},
      {OperatorAction::kFollow, FlightState::kFollow, {}, Outcome::kConfirmed},
      {OperatorAction::kFollow, FlightState::kIdle, {"arm refused: load"}, Outcome::kAwaited},
      {OperatorAction::kTakeOff, FlightState::kHold, {}, Outcome::kConfirmed},
      {OperatorAction::kTakeOff, FlightState::kIdle, {"take-off refused: load"}, Outcome::kRefused},
      {OperatorAction::kArm, FlightState::kIdle, {"arm pending"}, Outcome::kAwaited},
      {OperatorAction::kArm, FlightState::kIdle, {"arm refused: no pose"}, Outcome::kRefused},
      {OperatorAction::kArm, FlightState::kIdle, {}, Outcome::kConfirmed}};
  for (const Row& row : rows) {
    OrderReceipts receipts;
    receipts.on_status(status_of(row.state, row.reasons), kStart);
    EXPECT_TRUE(receipts.receipts().empty()) << "no order was sent";
    receipts.on_order(row.action, {"Q1"}, kStart);
    receipts.on_status(status_of(row.state, row.reasons), kStart);
    EXPECT_EQ(receipts.receipts().at("Q1").outcome, Outcome::kAwaited) << "an old status";
    receipts.on_status(status_of(row.state, row.reasons), kStart + Duration{1});
    EXPECT_EQ(receipts.receipts().at("Q1").outcome, row.outcome)
        << static_cast<int>(row.action) << " in " << name_of(row.state);
    receipts.tick(kStart + OrderReceipts::kPatience + Duration{1});
    EXPECT_EQ(receipts.receipts().at("Q1").outcome,
              row.outcome == Outcome::kAwaited ? Outcome::kUnconfirmed : row.outcome);
  }
}

TEST(OrderReceipts, NameTheStateAndTheReasons) {
  OrderReceipts receipts;
  receipts.on_order(OperatorAction::kArm, {"Q1", "Q2"}, kStart);
  receipts.on_status(status_of(FlightState::kIdle, {"arm refused: no pose"}), kStart + Duration{1});
  receipts.tick(kStart + OrderReceipts::kPatience + Duration{1});
  EXPECT_EQ(receipts.receipts().at("Q1").words, "idle, arm refused: no pose");
  EXPECT_EQ(receipts.receipts().at("Q2").words, "no status received");
  EXPECT_STREQ(name_of(receipts.receipts().at("Q2").outcome), "unconfirmed");
}

TEST(OrderReceipts, KeepAnAwaitedEmergencyStop) {
  OrderReceipts receipts;
  receipts.on_order(OperatorAction::kEmergencyStop, {"Q1"}, kStart);
  receipts.on_order(OperatorAction::kFollow, {"Q1"}, kStart + Duration{1});
  EXPECT_EQ(receipts.receipts().at("Q1").action, OperatorAction::kEmergencyStop);
  receipts.on_status(status_of(FlightState::kKilled), kStart + Duration{2});
  receipts.on_order(OperatorAction::kArm, {"Q1"}, kStart + Duration{3});
  EXPECT_EQ(receipts.receipts().at("Q1").action, OperatorAction::kArm);
}

}  // namespace
}  // namespace vantage::tools
