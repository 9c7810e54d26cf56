#pragma once

#include <cstdint>
#include <span>
#include <string>

struct ddsi_serdata;
struct ddsi_sertype;

namespace vantage::tools::ros2 {

/// Returns a type of Cyclone DDS without keys whose messages are serialised bytes, so that a topic
/// of any ROS 2 type needs no generated code. dds_create_topic_sertype() takes ownership.
/// @param name  name of the type in DDS
ddsi_sertype* new_cdr_type(const std::string& name);

/// Returns a new message of a type from new_cdr_type(). `cdr` begins with the encapsulation header.
/// dds_writecdr() takes ownership.
ddsi_serdata* new_cdr_message(const ddsi_sertype* type, std::span<const std::uint8_t> cdr);

/// Returns the bytes of a message of a type from new_cdr_type().
std::span<const std::uint8_t> cdr_of(const ddsi_serdata* message);

}  // namespace vantage::tools::ros2
