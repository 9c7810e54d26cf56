#include "drivers/camera/folder_source.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "test/support/temporary_folder.hpp"

namespace vantage::drivers::camera {
namespace {

constexpr Time kNow = from_utime(1'700'000'000'000'000);
constexpr const char* kImage = "P5 2 2 255\nabcd";

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(TimeInName, IsTheLastNumberWithEnoughDigits) {
  EXPECT_EQ(time_in_name("1700000000000000.pgm"), kNow);
  EXPECT_EQ(time_in_name("cam2_1700000000000000_0001.png"), kNow);
  EXPECT_FALSE(time_in_name("frame_0001.pgm"));
  EXPECT_FALSE(time_in_name("99999999999999999999999.pgm"));
}

TEST(FolderSource, DeliversAFileWhenItsWriterHasClosedIt) {
  const test::TemporaryFolder folder;
  write(folder.file("1600000000000000.pgm"), kImage);  // before the start
  FolderSource source(folder.path());
  EXPECT_FALSE(source.next(kNow));
  {
    std::ofstream file(folder.file("1700000000000001.pgm"), std::ios::binary);
    file << "P5 2 2 255\nab" << std::flush;
    EXPECT_FALSE(source.next(kNow)) << "the writer has not closed the file";
    file << "cd";
  }
  const auto first = source.next(kNow);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->time, kNow + Duration{1});
  EXPECT_EQ(first->image.at(1, 1), 'd');
  write(folder.file("hidden.part"), kImage);
  std::filesystem::rename(folder.file("hidden.part"), folder.file("1700000000000002.pgm"));
  const auto second = source.next(kNow);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->time, kNow + Duration{2});
  EXPECT_FALSE(source.next(kNow));
  EXPECT_EQ(source.counts().undecodable, 0);
}

TEST(FolderSource, ReadsExistingFilesInOrderIfConfigured) {
  const test::TemporaryFolder folder;
  write(folder.file("b.pgm"), kImage);
  write(folder.file("a.pgm"), kImage);
  write(folder.file("times.csv"), "a.pgm,1700000000000000\nb.pgm,1700000000000005\nno line\n");
  FolderSource source(folder.path(), true);
  EXPECT_EQ(source.next(kNow)->time, kNow);
  EXPECT_EQ(source.next(kNow)->time, kNow + Duration{5});
  EXPECT_FALSE(source.next(kNow));
}

TEST(FolderSource, CountsFilesThatAreNotImages) {
  const test::TemporaryFolder folder;
  FolderSource source(folder.path());
  EXPECT_FALSE(source.next(kNow));
  write(folder.file("1700000000000001.pgm"), "P5 2 2 255\nabc");      // truncated
  write(folder.file("1700000000000002.pgm"), "");                     // empty: a full disk
  write(folder.file("1700000000000003.png"), "not a PNG at all");     // damaged
  write(folder.file("1700000000000004.pgm"), "P5 99999 9 255\nabc");  // huge
  write(folder.file("frame1.pgm"), kImage);                           // no time in the name
  write(folder.file("notes.txt"), "text");                            // ignored
  std::filesystem::create_directory(folder.file("1700000000000005.pgm"));
  std::filesystem::create_directory(folder.file("moved"));
  std::filesystem::rename(folder.file("moved"), folder.file("1700000000000006.pgm"));
  EXPECT_FALSE(source.next(kNow));
  EXPECT_EQ(source.counts().undecodable, 5);
  EXPECT_EQ(source.counts().unstamped, 1);
}

TEST(FolderSource, SkipsFilesThatWereRemovedBeforeTheyWereRead) {
  const test::TemporaryFolder folder;
  FolderSource source(folder.path());
  EXPECT_FALSE(source.next(kNow));
  write(folder.file("1700000000000001.pgm"), kImage);
  std::filesystem::remove(folder.file("1700000000000001.pgm"));
  write(folder.file("1700000000000002.pgm"), kImage);
  EXPECT_EQ(source.next(kNow)->time, kNow + Duration{2});
  EXPECT_EQ(source.counts().undecodable, 1);
}

TEST(FolderSource, ReopensAFolderThatWasRemovedAndCreatedAgain) {
  const test::TemporaryFolder parent;
  const std::string folder = parent.file("images");
  FolderSource source(folder);
  EXPECT_FALSE(source.next(kNow));
  EXPECT_NE(source.status().find("cannot be read"), std::string::npos) << source.status();
  std::filesystem::create_directory(folder);
  EXPECT_FALSE(source.next(kNow + kReopenPeriod));
  EXPECT_NE(source.status().find("is open"), std::string::npos) << source.status();
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(source.next(kNow + kReopenPeriod));
  EXPECT_EQ(source.counts().interruptions, 1);
  std::filesystem::create_directory(folder);
  EXPECT_FALSE(source.next(kNow + 2 * kReopenPeriod));
  write(folder + "/1700000000000009.pgm", kImage);
  EXPECT_TRUE(source.next(kNow + 2 * kReopenPeriod));
}

TEST(FolderSource, DropsTheOldestOfManyWaitingFiles) {
  const test::TemporaryFolder folder;
  FolderSource source(folder.path());
  EXPECT_FALSE(source.next(kNow));
  for (int i = 0; i < 300; ++i) {
    write(folder.file(std::to_string(1'700'000'000'000'000 + i) + ".pgm"), kImage);
  }
  EXPECT_EQ(source.next(kNow)->time, kNow + Duration{44});
  EXPECT_EQ(source.counts().lost, 44);
}

}  // namespace
}  // namespace vantage::drivers::camera
