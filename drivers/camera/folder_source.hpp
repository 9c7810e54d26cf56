#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "drivers/camera/image_source.hpp"

namespace vantage::drivers::camera {

/// Returns the time in a file name: the last number with at least 10 digits, in µs since the Unix
/// epoch ("left_1700000000000000.png"). Nullopt if there is none.
std::optional<Time> time_in_name(const std::string& name);

/// Images that other programs write into a folder. A file is read when its writer closes it or
/// gives it its final name. The time of an image is in the file name, or in the file times.csv of
/// the folder, which has lines "NAME,TIME" with the time in µs since the Unix epoch.
class FolderSource : public ImageSource {
 public:
  /// @param reads_present  true: the files that exist already are read, too, in the order of their
  ///                       names
  explicit FolderSource(std::string folder, bool reads_present = false);
  ~FolderSource() override;
  FolderSource(const FolderSource&) = delete;
  FolderSource& operator=(const FolderSource&) = delete;
  FolderSource(FolderSource&&) = delete;
  FolderSource& operator=(FolderSource&&) = delete;

  std::optional<CapturedImage> next(Time now) override;
  [[nodiscard]] SourceCounts counts() const override { return counts_; }
  [[nodiscard]] std::string status() const override { return status_; }

 private:
  static constexpr std::size_t kWaitingMax = 256;

  void open(Time now);
  void close();
  void read_events();
  void add_present();
  void add(const std::string& name);
  std::optional<CapturedImage> read(const std::string& name);
  void read_times();

  std::string folder_;
  bool reads_present_;
  int inotify_ = -1;
  Time next_try_{};
  std::deque<std::string> waiting_;
  std::map<std::string, Time> times_;
  SourceCounts counts_;
  std::string status_;
};

}  // namespace vantage::drivers::camera
