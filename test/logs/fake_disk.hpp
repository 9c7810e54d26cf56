#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "logs/record/append_file.hpp"

namespace vantage::logs::test {

/// An emulated disk that fills up, hangs and fails on command. Thread-safe.
class FakeDisk {
 public:
  using Bytes = std::vector<std::uint8_t>;

  OpenFile opener() {
    return [this](const std::string& path, Existing existing) { return open(path, existing); };
  }

  void set_room(std::size_t bytes) {
    change([&] { room_bytes_ = bytes; });
  }
  void hang_append(bool hangs) {
    change([&] { append_hangs_ = hangs; });
  }
  void hang_sync(bool hangs) {
    change([&] { sync_hangs_ = hangs; });
  }
  void fail_sync(bool fails) {
    change([&] { sync_fails_ = fails; });
  }
  Bytes bytes(const std::string& path) {
    const std::lock_guard lock(mutex_);
    return files_[path].bytes;
  }
  std::optional<std::uint64_t> free_bytes() {
    const std::lock_guard lock(mutex_);
    const bool is_endless = room_bytes_ > std::numeric_limits<std::size_t>::max() / 2;
    return is_endless ? std::nullopt : std::optional<std::uint64_t>(room_bytes_);
  }
  std::size_t synced_bytes(const std::string& path) {
    const std::lock_guard lock(mutex_);
    return files_[path].synced_bytes;
  }
  /// Waits up to 20 s until a thread is blocked in an append that hangs; returns false on time-out.
  bool wait_for_hanging_append() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [&] { return appends_hanging_ > 0; });
  }
  /// Waits until `holds(bytes, synced bytes)` is true for the file; returns false after 20 s.
  bool wait_for(const std::string& path,
                const std::function<bool(const Bytes&, std::size_t)>& holds) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20),
                             [&] { return holds(files_[path].bytes, files_[path].synced_bytes); });
  }

 private:
  struct Content {
    Bytes bytes;
    std::size_t synced_bytes = 0;
  };

  class File : public AppendFile {
   public:
    File(FakeDisk& disk, std::string path) : disk_(disk), path_(std::move(path)) {}
    Result<std::size_t> append(std::span<const std::uint8_t> bytes) override {
      return disk_.append(path_, bytes);
    }
    std::optional<Error> sync() override { return disk_.sync(path_); }
    std::optional<Error> cut(std::uint64_t size_bytes) override {
      disk_.change([&] { disk_.files_[path_].bytes.resize(size_bytes); });
      return std::nullopt;
    }
    [[nodiscard]] std::uint64_t size_bytes() const override { return disk_.bytes(path_).size(); }
    /// Returns the free space that the test has set; nullopt if it has set none.
    [[nodiscard]] std::optional<std::uint64_t> free_bytes() const override {
      return disk_.free_bytes();
    }

   private:
    FakeDisk& disk_;
    std::string path_;
  };

  void change(const std::function<void()>& what) {
    const std::lock_guard lock(mutex_);
    what();
    changed_.notify_all();
  }

  Result<std::unique_ptr<AppendFile>> open(const std::string& path, Existing existing) {
    const std::lock_guard lock(mutex_);
    if (existing == Existing::kRefuse && files_.count(path) > 0) {
      return Error{path + ": exists already"};
    }
    files_[path];
    return std::unique_ptr<AppendFile>(std::make_unique<File>(*this, path));
  }

  Result<std::size_t> append(const std::string& path, std::span<const std::uint8_t> bytes) {
    std::unique_lock lock(mutex_);
    ++appends_hanging_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !append_hangs_; });
    --appends_hanging_;
    const std::size_t taken = std::min(bytes.size(), room_bytes_);
    if (taken == 0) {
      return Error{path + ": cannot be written: No space left on device"};
    }
    room_bytes_ -= taken;
    Bytes& content = files_[path].bytes;
    content.insert(content.end(), bytes.begin(),
                   bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    changed_.notify_all();
    return taken;
  }

  std::optional<Error> sync(const std::string& path) {
    std::unique_lock lock(mutex_);
    Content& content = files_[path];
    const std::size_t size = content.bytes.size();
    changed_.wait(lock, [&] { return !sync_hangs_; });
    if (sync_fails_) {
      return Error{path +
                   ": the last data may not have been written to the disk: Input/output error"};
    }
    content.synced_bytes = size;
    changed_.notify_all();
    return std::nullopt;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Content> files_;
  std::size_t room_bytes_ = std::numeric_limits<std::size_t>::max();
  bool append_hangs_ = false;
  int appends_hanging_ = 0;
  bool sync_hangs_ = false;
  bool sync_fails_ = false;
};

}  // namespace vantage::logs::test
