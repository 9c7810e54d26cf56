#include "sim/vicon/object_stream_server.hpp"

#include <algorithm>

#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {

const std::vector<std::vector<std::uint8_t>>& ObjectStreamServer::encode(
    const EmulatedFrame& frame) {
  std::vector<wire::vicon::TrackerObject> objects;
  for (const EmulatedBody& body : frame.bodies) {
    wire::vicon::TrackerObject object;
    object.set_name(body.name);
    if (!body.is_occluded) {
      const Pose3 pose = settings_.is_y_up ? wire::vicon::y_up_from_z_up(body.world_from_body)
                                           : body.world_from_body;
      object.translation_mm = 1e3 * pose.translation_m;
      object.euler_xyz_rad = wire::vicon::euler_xyz_from_rotation(pose.rotation);
      last_seen_[body.name] = object;
    } else if (settings_.occlusion == OcclusionStyle::kAbsent) {
      continue;
    } else if (settings_.occlusion == OcclusionStyle::kRepeated) {
      object = last_seen_.try_emplace(body.name, object).first->second;
    }
    objects.push_back(object);
  }
  const std::size_t fit =
      std::max<std::size_t>(1, wire::vicon::objects_per_block(settings_.block_bytes));
  datagrams_.resize(std::max<std::size_t>(1, (objects.size() + fit - 1) / fit));
  for (std::size_t k = 0; k < datagrams_.size(); ++k) {
    const std::size_t begin = k * fit;
    const std::size_t end = std::min(begin + fit, objects.size());
    wire::vicon::ObjectBlock block;
    block.frame_number = frame.number;
    block.objects.assign(objects.begin() + static_cast<std::ptrdiff_t>(begin),
                         objects.begin() + static_cast<std::ptrdiff_t>(end));
    wire::vicon::encode_object_block(block, settings_.block_bytes, datagrams_[k]);
  }
  return datagrams_;
}

}  // namespace vantage::sim::vicon
