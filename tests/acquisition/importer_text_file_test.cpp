// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using tests::WrittenFile;

TEST(TextFile, CountsLinesAndColumnsFromOneAndBytesFromZero) {
  const WrittenFile written("ab\ncd\r\nef");
  const TextFile file(written.path());
  const char* const start = file.bytes().data();
  EXPECT_EQ(file.position(start).text(), written.path() + ":1:1 (byte 0)");
  EXPECT_EQ(file.position(start + 4).text(), written.path() + ":2:2 (byte 4)");
  EXPECT_EQ(file.position(start + 8).text(), written.path() + ":3:2 (byte 8)");
  EXPECT_EQ(file.byte_position(start + 8).text(), written.path() + " (byte 8)");
}

TEST(TextFile, LeavesOffTheByteOrderMark) {
  const WrittenFile written("\xEF\xBB\xBFtime");
  TextFile file(written.path());
  EXPECT_EQ(file.text(), "time");
  EXPECT_EQ(file.position(file.text().data()).byte, 3U);
}

TEST(TextFile, LeavesOffBytesOfZeroBehindIt) {
  const auto text = [](const std::string& bytes) {
    const tests::WrittenFile file(bytes);
    TextFile read(file.path());
    return std::string(read.text());
  };
  EXPECT_EQ(text(std::string("a\nb\0\0", 5)), "a\nb");
  EXPECT_EQ(text(std::string("a\rb\0", 4)), "a\nb");
  EXPECT_EQ(text(std::string("\xFF\xFE"
                             "a\0\n\0",
                             6)),
            "a\n");                                        // UTF-16 ends with them
  EXPECT_EQ(padding_of(std::string_view("\0\0", 2)), 0U);  // no text at all
}

// Both on the disk and as a hole that the file system knows of; it is looked at by blocks.
TEST(TextFile, LeavesOffAnyNumberOfBytesOfZero) {
  constexpr std::size_t block = std::size_t{1} << 20;
  for (const std::size_t zeros : {block - 3, block - 2, block - 1, block, 3 * block + 5}) {
    const WrittenFile written("a\nb" + std::string(zeros, '\0'));
    EXPECT_EQ(TextFile(written.path()).text(), "a\nb") << zeros;
    const WrittenFile hole("a\nb", ".hole");
    std::filesystem::resize_file(hole.path(), 3 + zeros);
    EXPECT_EQ(TextFile(hole.path()).text(), "a\nb") << zeros;
  }
}

/// What this process holds of files [kB].
std::size_t held_of_files() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("RssFile:")) return std::stoul(line.substr(8));
  return 0;
}

TEST(TextFile, HoldsNoBytesOfZeroBehindIt) {
  constexpr std::size_t megabytes = 48;
  const WrittenFile written("a\nb" + std::string(megabytes << 20, '\0'));
  const std::size_t before = held_of_files();
  ASSERT_GT(before, 0U);
  TextFile file(written.path());
  EXPECT_EQ(file.text(), "a\nb");
  EXPECT_LT(held_of_files(), before + 8 * 1024);
}

TEST(TextFile, TurnsUtf16IntoUtf8) {
  using namespace std::string_view_literals;
  const WrittenFile little(
      "\xFF\xFE"
      "a\0\xB5\0\xAC\x20\x3D\xD8\x00\xDE\x00\xD8x\0"sv);
  const WrittenFile big("\xFE\xFF\0a\0\xB5\x20\xAC\xD8\x3D\xDE\x00\xD8\x00\0x"sv, ".big");
  const std::string expected =
      "a\u00B5\u20AC\U0001F600\uFFFDx";  // the last but one: half a surrogate pair
  TextFile first(little.path());
  TextFile second(big.path());
  EXPECT_EQ(first.text(), expected);
  EXPECT_EQ(second.text(), expected);
}

// Whatever the pieces: also where a pair of surrogates would be cut in two.
TEST(TextFile, TurnsUtf16OnTheDiskIntoTheSameUtf8) {
  using namespace std::string_view_literals;
  const std::string letters(
      "a\0\xB5\0\xAC\x20\x3D\xD8\x00\xDE\x00\xD8\x3D\xD8\x3D\xD8\x00\xDEx\0\x3D\xD8"sv);
  std::string swapped = letters;
  for (std::size_t i = 0; i + 1 < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
  for (const std::string& bytes :
       {"\xFF\xFE" + letters, "\xFE\xFF" + swapped, "\xFF\xFE" + letters + "y"}) {
    const WrittenFile written(bytes);
    const MappedFile file(written.path());
    const std::string expected = "a\u00B5\u20AC\U0001F600\uFFFD\uFFFD\U0001F600x\uFFFD";
    EXPECT_EQ(utf16_to_utf8(bytes), expected);
    for (std::size_t piece = 2; piece < 28; ++piece)
      EXPECT_EQ(rewritten(file, utf16_rewriting(bytes), piece)->bytes(), expected) << piece;
  }
}

TEST(TextFile, TakesCarriageReturnsAloneForLineEndsOnTheDiskToo) {
  const WrittenFile written("a\rbc\r\rd");
  const MappedFile file(written.path());
  for (const std::size_t piece : {1U, 3U, 100U})
    EXPECT_EQ(rewritten(file, line_feed_rewriting(), piece)->bytes(), "a\nbc\n\nd");
}

// 34 MB are rewritten on the disk; a place in them is still one of the text.
TEST(TextFile, ALargeUtf16TextIsReadWithItsPlaces) {
  std::string bytes = "\xFF\xFE";
  const std::string row("1\0,\0002\0\n\0", 8);
  for (std::size_t i = 0; i < (std::size_t{34} << 20) / row.size(); ++i) bytes += row;
  const WrittenFile written(bytes, ".csv");
  TextFile file(written.path());
  const std::string_view text = file.text();
  EXPECT_EQ(text.size(), (bytes.size() - 2) / 2);
  EXPECT_TRUE(text.ends_with("1,2\n"));
  EXPECT_EQ(file.text().data(), text.data());
  EXPECT_EQ(file.position(text.data() + 6).text(), written.path() + ":2:3");
  file.release(text.data(), text.data() + text.size());
  EXPECT_TRUE(text.ends_with("1,2\n"));
}

TEST(TextFile, RefusesUtf16WithoutItsMark) {
  using namespace std::string_view_literals;
  EXPECT_EQ(
      tests::import_error("t\0,\0F\0\n\0"
                          "1\0,\0"
                          "2\0\n\0"sv,
                          {}, ".csv"),
      "FILE (byte 0): the text looks like UTF-16 without a byte order mark: save it as UTF-8");
}

TEST(TextFile, TakesCarriageReturnsAloneForLineEnds) {
  const WrittenFile written("a\rb\r");
  TextFile file(written.path());
  EXPECT_EQ(file.text(), "a\nb\n");
  EXPECT_EQ(file.position(file.text().data() + 2).line, 2U);
}

TEST(TextFile, CannotBeADirectoryADeviceOrAbsent) {
  const auto message = [](const std::string& path) {
    try {
      const TextFile file(path);
    } catch (const datasets::FileError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message("/no/such/file"), "/no/such/file: cannot be opened: No such file or directory");
  EXPECT_EQ(message("/"), "/: is a directory, a recording is expected");
  EXPECT_THAT(message("-"), testing::HasSubstr("standard input is not read: save the recording"));
  EXPECT_EQ(message("/dev/null"), "/dev/null: is not a file on a disk; save the recording to one");
  const std::string pipe = testing::TempDir() + "impactrig_pipe" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(message(pipe),
            pipe + ": is not a file on a disk; save the recording to one");  // and does not wait
                                                                             // for a writer
  unlink(pipe.c_str());
}

TEST(Utf8, StaysWhatItIs) {
  EXPECT_EQ(to_utf8("m/s\u00B2 \u20AC \U0001F600"), "m/s\u00B2 \u20AC \U0001F600");
}

TEST(Utf8, IsMadeOfLatin1AndItsWindowsAdditions) {
  EXPECT_EQ(to_utf8("m/s\xB2"), "m/s\u00B2");
  EXPECT_EQ(to_utf8("\x80\x96\x81"), "\u20AC\u2013\uFFFD");
}

// RFC 3629: overlong forms, surrogates and code points above U+10FFFF are no UTF-8, so the bytes
// are latin-1.
TEST(Utf8, IsNeverInvalid) {
  for (const char* bytes : {"\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                            "\xF0\x80\x80\x80", "\xC3", "\xE2\x82", "\xF0\x9F\x98", "\xFF"}) {
    const std::string once = to_utf8(bytes);
    EXPECT_NE(once, bytes);
    EXPECT_EQ(to_utf8(once), once);  // valid text is not touched again
  }
}

TEST(Utf8, HasNoControlCharacters) {
  EXPECT_EQ(to_utf8(std::string_view("a\0b\tc\x7F", 6)), "a b c ");
}

}  // namespace
}  // namespace impactrig::acquisition
