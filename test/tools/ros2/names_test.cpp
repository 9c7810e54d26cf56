#include "tools/ros2/names.hpp"

#include <string_view>

#include <gtest/gtest.h>

namespace vantage::tools::ros2 {
namespace {

struct KnownHash {
  std::string_view type;
  std::string_view hash;  ///< as printed by `ros2 topic info --verbose` of Jazzy
};

constexpr KnownHash kKnown[] = {
    {"std_msgs/msg/Header",
     "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"},
    {"geometry_msgs/msg/Twist",
     "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
    {"tf2_msgs/msg/TFMessage",
     "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
    {"nav_msgs/msg/Path",
     "RIHS01_1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
    {"nav_msgs/msg/Odometry",
     "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    {"geometry_msgs/msg/PoseStamped",
     "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
    {"geometry_msgs/msg/PoseWithCovarianceStamped",
     "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
    {"sensor_msgs/msg/BatteryState",
     "RIHS01_4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741"},
    {"diagnostic_msgs/msg/DiagnosticArray",
     "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
    {"visualization_msgs/msg/MarkerArray",
     "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
    {"vision_msgs/msg/Detection3DArray",
     "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"},
};

TEST(Ros2Names, HaveTheTypeHashesOfRos2) {
  for (const KnownHash& each : kKnown) {
    EXPECT_EQ(type_hash(each.type), each.hash) << each.type;
  }
  EXPECT_EQ(type_hash_user_data("nav_msgs/msg/Path"),
            "typehash=" + type_hash("nav_msgs/msg/Path") + ";");
}

TEST(Ros2Names, EqualTheNamesThatDdsUses) {
  EXPECT_EQ(dds_topic("/Q1/plan"), "rt/Q1/plan");
  EXPECT_EQ(dds_type("tf2_msgs/msg/TFMessage"), "tf2_msgs::msg::dds_::TFMessage_");
}

}  // namespace
}  // namespace vantage::tools::ros2
