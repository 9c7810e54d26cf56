#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/vicon/frame_assembly.hpp"
#include "drivers/vicon/session.hpp"
#include "drivers/vicon/vrpn_trackers.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::drivers::vicon {

/// Client of a VRPN server over TCP only. Each sender of poses is a body; its sensor 0 gives the
/// body's pose, other sensors give limbs. A frame contains the poses with nearly the same stamp,
/// and the extrapolated poses of trackers that report at other instants (VrpnTrackers).
class VrpnSession : public Session {
 public:
  VrpnSession(bool is_y_up, FrameSink sink);

  void open(Moment now) override;
  [[nodiscard]] bool receive(Moment arrival, wire::vicon::Bytes bytes) override;
  void on_time(Moment now) override;
  [[nodiscard]] Duration next_wake() const override;
  [[nodiscard]] std::vector<BodyRate> rates() const override { return trackers_.rates(); }

 private:
  static constexpr std::size_t kNamesMax = 1024;
  struct Name {
    std::int32_t id = 0;
    std::string name;
  };
  static void learn(std::vector<Name>& names, std::int32_t id, std::string_view name);
  static const std::string* find(const std::vector<Name>& names, std::int32_t id);

  [[nodiscard]] bool read_cookie();
  void on_message(Moment arrival, const wire::vicon::VrpnHeader& header,
                  wire::vicon::Bytes payload);
  void on_pose(Moment arrival, const wire::vicon::VrpnHeader& header, wire::vicon::Bytes payload);

  bool is_y_up_;
  VrpnTrackers trackers_;
  FrameAssembly assembly_;
  wire::vicon::StreamBuffer stream_;
  std::optional<wire::vicon::VrpnVersion> version_;
  std::vector<Name> senders_;
  std::vector<Name> types_;
  std::int32_t pose_type_ = 0;  ///< type number that the server announced for poses
  bool has_pose_type_ = false;
  bool is_introduced_ = false;       ///< the client's names were sent
  std::int64_t frame_stamp_us_ = 0;  ///< stamp of the frame in progress
  Duration next_ping_{Duration::max()};
};

}  // namespace vantage::drivers::vicon
