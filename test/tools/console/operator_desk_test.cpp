#include "tools/console/operator_desk.hpp"

#include <chrono>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace vantage::tools {
namespace {

constexpr const char* kKey = "0123456789abcdef";

/// A desk on a bus of this process without vehicles.
class OperatorDeskTest : public ::testing::Test {
 protected:
  nlohmann::json json_of(const DeskAnswer& answer) const {
    return nlohmann::json::parse(answer.json);
  }
  std::string claim() {
    return json_of(desk.answer("claim", kKey, "", ""))["token"].get<std::string>();
  }
  DeskAnswer order(const std::string& token, const std::string& action,
                   const std::string& robot = "") {
    return desk.answer("order", kKey, token,
                       nlohmann::json{{"action", action}, {"robot", robot}}.dump());
  }
  /// Returns the journal's lines as soon as one contains `words`, else those after 10 s.
  std::string journal_with(const std::string& words) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    std::string text;
    do {
      text.clear();
      const auto state = json_of(desk.answer("state", kKey, "", ""));
      for (const auto& line : state["station"].value("journal", nlohmann::json::array())) {
        text += line["words"].get<std::string>() + "\n";
      }
      std::this_thread::yield();
    } while (text.find(words) == std::string::npos && std::chrono::steady_clock::now() < end);
    return text;
  }

  OperatorLink link{"memq://", ""};
  OperatorDesk desk{link, kKey};
};

TEST_F(OperatorDeskTest, RefusesInvalidRequests) {
  const std::string token = claim();
  const std::string too_long(OperatorDesk::kBodyBytesMax + 1, 'a');
  const struct {
    const char* what;
    const char* key;
    std::string body;
    int code;
    const char* words;
  } rows[] = {
      {"claim", "", "", 403, "wrong key"},
      {"claim", "0123456789abcdeF", "", 403, "wrong key"},
      {"state", "0123456789abcde", "", 403, "wrong key"},
      {"order", "", R"({"action":"estop","robot":""})", 403, "wrong key"},
      {"fly", kKey, "", 400, "unknown request"},
      {"", kKey, "", 400, "unknown request"},
      {"order", kKey, too_long, 400, "too long"},
      {"order", kKey, "", 400, "an order is"},
      {"order", kKey, "[]", 400, "an order is"},
      {"order", kKey, R"({"action":"arm"})", 400, "an order is"},
      {"order", kKey, R"({"action":1,"robot":""})", 400, "an order is"},
      {"order", kKey, R"({"action":"arm Q1","robot":""})", 400, "not one word"},
      {"order", kKey, R"({"action":"arm","robot":")" + std::string(65, 'Q') + "\"}", 400,
       "name is too long"},
      {"order", kKey, R"({"action":"dance","robot":""})", 400, "dance"},
      {"order", kKey, R"({"action":"quit","robot":""})", 400, "is not an order"},
  };
  for (const auto& row : rows) {
    const DeskAnswer answer = desk.answer(row.what, row.key, token, row.body);
    EXPECT_EQ(answer.code, row.code) << row.what << ' ' << row.body;
    EXPECT_NE(answer.json.find(row.words), std::string::npos) << answer.json;
  }
}

TEST_F(OperatorDeskTest, GivesTheClaimToOnePageUntilItIsReleased) {
  const std::string token = claim();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(desk.answer("claim", kKey, "", "").code, 409);
  EXPECT_TRUE(json_of(desk.answer("state", kKey, token, ""))["is_operator"].get<bool>());
  EXPECT_FALSE(json_of(desk.answer("state", kKey, "another", ""))["is_operator"].get<bool>());
  EXPECT_EQ(desk.answer("release", kKey, "another", "").code, 200);
  EXPECT_EQ(desk.answer("claim", kKey, "", "").code, 409) << "only its page ends a claim";
  EXPECT_EQ(desk.answer("release", kKey, token, "").code, 200);
  EXPECT_EQ(order(token, "hold").code, 409);
  EXPECT_NE(claim(), token);
}

TEST_F(OperatorDeskTest, AcceptsOrdersFromTheHolderOfTheClaimOnly) {
  const std::string token = claim();
  for (const char* action : {"arm", "take-off", "follow", "hold", "land"}) {
    EXPECT_EQ(order(token, action, "Q1").code, 200) << action;
    EXPECT_EQ(order("another", action, "Q1").code, 409) << action;
  }
}

TEST_F(OperatorDeskTest, AcceptsTheEmergencyStopWithoutAClaim) {
  static_cast<void>(claim());
  EXPECT_EQ(order("", "estop").code, 200);
  EXPECT_NE(journal_with("sent estop to all").find("sent estop to all"), std::string::npos);
}

TEST_F(OperatorDeskTest, AcceptsTheEmergencyStopAlthoughTooManyOrdersWait) {
  const std::string token = claim();
  int refused = 0;
  for (int i = 0; i < 100'000 && refused == 0; ++i) {
    refused += order(token, "hold", "Q1").code == 429 ? 1 : 0;
  }
  EXPECT_EQ(refused, 1);
  EXPECT_EQ(order("", "estop").code, 200);
  EXPECT_NE(journal_with("sent estop to all").find("sent estop to all"), std::string::npos);
}

TEST(NewSecret, HasThirtyTwoHexadecimalDigitsAndIsNeverTheSame) {
  const std::string secret = new_secret();
  EXPECT_EQ(secret.size(), 32U);
  EXPECT_EQ(secret.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(secret, new_secret());
}

}  // namespace
}  // namespace vantage::tools
