#pragma once

#include <array>
#include <string_view>

// Definitions of ROS 2 messages as in common_interfaces and vision_msgs 4, without comments.

namespace vantage::logs::ros2 {

struct Definition {
  std::string_view type;    ///< type's name as package/Name
  std::string_view fields;  ///< definition text, one field per line
};

inline constexpr std::array kDefinitions{
    Definition{"tf2_msgs/TFMessage", R"(geometry_msgs/TransformStamped[] transforms
)"},
    Definition{"geometry_msgs/TransformStamped", R"(std_msgs/Header header
string child_frame_id
geometry_msgs/Transform transform
)"},
    Definition{"std_msgs/Header", R"(builtin_interfaces/Time stamp
string frame_id
)"},
    Definition{"builtin_interfaces/Time", R"(int32 sec
uint32 nanosec
)"},
    Definition{"geometry_msgs/Transform", R"(geometry_msgs/Vector3 translation
geometry_msgs/Quaternion rotation
)"},
    Definition{"geometry_msgs/Vector3", R"(float64 x
float64 y
float64 z
)"},
    Definition{"geometry_msgs/Quaternion", R"(float64 x 0
float64 y 0
float64 z 0
float64 w 1
)"},
    Definition{"geometry_msgs/PoseWithCovarianceStamped", R"(std_msgs/Header header
geometry_msgs/PoseWithCovariance pose
)"},
    Definition{"geometry_msgs/PoseWithCovariance", R"(geometry_msgs/Pose pose
float64[36] covariance
)"},
    Definition{"geometry_msgs/Pose", R"(geometry_msgs/Point position
geometry_msgs/Quaternion orientation
)"},
    Definition{"geometry_msgs/Point", R"(float64 x
float64 y
float64 z
)"},
    Definition{"sensor_msgs/LaserScan", R"(std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
)"},
    Definition{"nav_msgs/OccupancyGrid", R"(std_msgs/Header header
nav_msgs/MapMetaData info
int8[] data
)"},
    Definition{"nav_msgs/MapMetaData", R"(builtin_interfaces/Time map_load_time
float32 resolution
uint32 width
uint32 height
geometry_msgs/Pose origin
)"},
    Definition{"nav_msgs/Path", R"(std_msgs/Header header
geometry_msgs/PoseStamped[] poses
)"},
    Definition{"geometry_msgs/PoseStamped", R"(std_msgs/Header header
geometry_msgs/Pose pose
)"},
    Definition{"sensor_msgs/BatteryState", R"(std_msgs/Header header
float32 voltage
float32 temperature
float32 current
float32 charge
float32 capacity
float32 design_capacity
float32 percentage
uint8 power_supply_status
uint8 power_supply_health
uint8 power_supply_technology
bool present
float32[] cell_voltage
float32[] cell_temperature
string location
string serial_number
)"},
    Definition{"diagnostic_msgs/DiagnosticArray", R"(std_msgs/Header header
diagnostic_msgs/DiagnosticStatus[] status
)"},
    Definition{"diagnostic_msgs/DiagnosticStatus", R"(byte OK=0
byte WARN=1
byte ERROR=2
byte STALE=3
byte level
string name
string message
string hardware_id
diagnostic_msgs/KeyValue[] values
)"},
    Definition{"diagnostic_msgs/KeyValue", R"(string key
string value
)"},
    Definition{"visualization_msgs/MarkerArray", R"(visualization_msgs/Marker[] markers
)"},
    Definition{"visualization_msgs/Marker", R"(std_msgs/Header header
string ns
int32 id
int32 type
int32 action
geometry_msgs/Pose pose
geometry_msgs/Vector3 scale
std_msgs/ColorRGBA color
builtin_interfaces/Duration lifetime
bool frame_locked
geometry_msgs/Point[] points
std_msgs/ColorRGBA[] colors
string texture_resource
sensor_msgs/CompressedImage texture
visualization_msgs/UVCoordinate[] uv_coordinates
string text
string mesh_resource
visualization_msgs/MeshFile mesh_file
bool mesh_use_embedded_materials
)"},
    Definition{"visualization_msgs/UVCoordinate", R"(float32 u
float32 v
)"},
    Definition{"visualization_msgs/MeshFile", R"(string filename
uint8[] data
)"},
    Definition{"sensor_msgs/CompressedImage", R"(std_msgs/Header header
string format
uint8[] data
)"},
    Definition{"std_msgs/ColorRGBA", R"(float32 r
float32 g
float32 b
float32 a
)"},
    Definition{"builtin_interfaces/Duration", R"(int32 sec
uint32 nanosec
)"},
    Definition{"geometry_msgs/Twist", R"(geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
)"},
    Definition{"geometry_msgs/TwistWithCovariance", R"(geometry_msgs/Twist twist
float64[36] covariance
)"},
    Definition{"nav_msgs/Odometry", R"(std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
)"},
    Definition{"vision_msgs/Detection3DArray", R"(std_msgs/Header header
vision_msgs/Detection3D[] detections
)"},
    Definition{"vision_msgs/Detection3D", R"(std_msgs/Header header
vision_msgs/ObjectHypothesisWithPose[] results
vision_msgs/BoundingBox3D bbox
string id
)"},
    Definition{"vision_msgs/ObjectHypothesisWithPose", R"(vision_msgs/ObjectHypothesis hypothesis
geometry_msgs/PoseWithCovariance pose
)"},
    Definition{"vision_msgs/ObjectHypothesis", R"(string class_id
float64 score
)"},
    Definition{"vision_msgs/BoundingBox3D", R"(geometry_msgs/Pose center
geometry_msgs/Vector3 size
)"},
};

}  // namespace vantage::logs::ros2
