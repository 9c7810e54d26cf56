#pragma once

#include <string>
#include <string_view>

// Names and type hashes by which ROS 2 maps its topics and types to DDS.

namespace vantage::tools::ros2 {

/// Returns the name of a topic in DDS: "rt/tf" for "/tf".
std::string dds_topic(std::string_view topic);

/// Returns the name of a type in DDS: "tf2_msgs::msg::dds_::TFMessage_" for
/// "tf2_msgs/msg/TFMessage".
std::string dds_type(std::string_view type);

/// Returns the type hash of ROS 2 Iron and later: "RIHS01_" and 64 hexadecimal digits. It is the
/// SHA-256 of the type's description in JSON.
/// Source: REP 2016, ROS 2 interface type descriptions; rosidl_generator_type_description.
/// Precondition: logs/export/ros2_definitions contains the type.
std::string type_hash(std::string_view type);

/// Returns the USER_DATA of a writer or reader, from which ROS 2 reads the type hash.
std::string type_hash_user_data(std::string_view type);

}  // namespace vantage::tools::ros2
