// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "acquisition/importer.hpp"
#include "acquisition/statistics.hpp"
#include "datasets/input_error.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

namespace fs = std::filesystem;

/// True when every byte sequence of a text is valid UTF-8 without control characters.
bool is_clean(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x20 || byte == 0x7F) return false;
    const std::size_t length = byte < 0x80    ? 1
                               : byte >= 0xF0 ? 4
                               : byte >= 0xE0 ? 3
                               : byte >= 0xC2 ? 2
                                              : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return false;
    i += length;
  }
  return true;
}

/// Reads bytes as a file: a record whose parts fit together, or an InputError.
void expect_record_or_error(const std::string& bytes, const std::string& ending) {
  const tests::WrittenFile file(bytes, ending);
  ImportOptions options;
  options.require_clock = false;
  try {
    const datasets::Record record = import_recording(file.path(), options);
    for (const datasets::Channel& channel : record.channels) {
      const std::size_t n = channel.size();
      ASSERT_LE(n, bytes.size());  // a sample takes a byte at least: nothing was made up
      ASSERT_TRUE(channel.valid.empty() || channel.valid.size() == n);
      ASSERT_TRUE(channel.imaginary.empty() || channel.imaginary.size() == n);
      ASSERT_TRUE(channel.clock.times.empty() || channel.clock.times.size() == n);
      ASSERT_TRUE(is_clean(channel.name) && is_clean(channel.unit))
          << channel.name << " " << channel.unit;
      for (const auto& [key, value] : channel.attributes)
        ASSERT_TRUE(is_clean(key) && is_clean(value)) << key;
      ASSERT_EQ(statistics(channel).samples, n);
    }
    for (const std::string& warning : record.warnings) ASSERT_TRUE(is_clean(warning)) << warning;
    for (const auto& [key, value] : record.attributes)
      ASSERT_TRUE(is_clean(key) && is_clean(value)) << key;
    ASSERT_TRUE(is_clean(record.title) && is_clean(record.started));
  } catch (const datasets::InputError& error) {
    ASSERT_TRUE(is_clean(error.what())) << error.what();
  }
}

class DamagedRecording : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const fs::path file = fs::path(IMPACTRIG_SHARED_DIR) / "recordings" / GetParam();
    if (!fs::exists(file)) GTEST_SKIP() << "no recordings at " << IMPACTRIG_SHARED_DIR;
    bytes_ = tests::bytes_of(file.string());
    ending_ = file.extension().string();
    // the head holds what can go wrong; a part of the data is enough behind it
    if (bytes_.size() > 60000) bytes_.resize(60000);
  }

  std::string bytes_;
  std::string ending_;
};

TEST_P(DamagedRecording, CutAnywhereIsReadOrRefused) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    // half of the cuts in the first two kilobytes, where the header is
    const std::size_t range =
        i % 2 == 0 ? std::min<std::size_t>(bytes_.size(), 2000) : bytes_.size();
    const std::size_t length = random() % range;
    SCOPED_TRACE(fmt::format("cut to {} bytes", length));
    expect_record_or_error(bytes_.substr(0, length), ending_);
    if (HasFatalFailure()) return;
  }
}

TEST_P(DamagedRecording, WithFlippedBytesIsReadOrRefused) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = bytes_;
    const std::size_t range =
        seed % 2 == 0 ? std::min<std::size_t>(bytes_.size(), 2000) : bytes_.size();
    for (unsigned k = 0; k < 1 + seed % 5; ++k)
      damaged[random() % range] = static_cast<char>(random());
    SCOPED_TRACE(fmt::format("seed {}", seed));
    expect_record_or_error(damaged, ending_);
    if (HasFatalFailure()) return;
  }
}

TEST_P(DamagedRecording, WithDigitsExchangedIsReadOrRefused) {
  for (unsigned seed = 0; seed < 100; ++seed) {  // counts, types and sizes that lie
    std::mt19937 random(seed);
    std::string damaged = bytes_;
    const std::size_t range = std::min<std::size_t>(bytes_.size(), 1000);
    for (int k = 0; k < 20; ++k) {
      char& c = damaged[random() % range];
      if (c >= '0' && c <= '9') c = static_cast<char>('0' + random() % 10);
      if (c == ' ' && random() % 8 == 0) c = static_cast<char>('0' + random() % 10);
    }
    SCOPED_TRACE(fmt::format("seed {}", seed));
    expect_record_or_error(damaged, ending_);
    if (HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shared, DamagedRecording,
    testing::Values("uff/binary8byte.uff", "uff/catman_time_history.uff", "uff/header_1858.uff",
                    "uff/mps_first_set_fixed.uff", "uff/sample_58_ascii.uff",
                    "uff/sample_58b_bin.uff", "uff/testlab_161_164_18_15_82.uff",
                    "text/drop_tower_accel_1.csv", "text/rigol_ds1054z.csv",
                    "text/rigol_ds1102d.csv", "text/rigol_ds1102e.csv", "text/shock_base.txt",
                    "text/tek_mso64.csv", "polytec_ascii/time_ref1_voltage.txt",
                    "polytec_ascii/time_velocity_clipboard.txt", "lvm/impact_5kg_headerless.lvm",
                    "lvm/hammer_short_decimal_comma.lvm", "lvm/multi_time_column.lvm",
                    "mat/tek_analog.mat", "mat/testcomplex_7.4_GLNX86.mat",
                    "mat/testdouble_6.1_SOL2.mat", "mat/teststruct_7.4_GLNX86.mat",
                    "mat/testhdf5_7.4_GLNX86.mat", "wav/test-8000Hz-le-2ch-1byteu.wav",
                    "wav/test-44100Hz-le-1ch-4bytes.wav"),
    [](const auto& instance) {
      std::string name = instance.param;
      for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      return name;
    });

TEST(Noise, IsReadOrRefused) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    constexpr std::string_view alphabet = "0123456789.,;-+eE \t\n\r\"#[]()ab";
    std::string text;
    const std::size_t length = random() % 400;
    for (std::size_t i = 0; i < length; ++i) text += alphabet[random() % alphabet.size()];
    SCOPED_TRACE(fmt::format("seed {}", seed));
    expect_record_or_error(text, ".csv");
    expect_record_or_error("    -1\n    58\n" + text, ".uff");
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace impactrig::acquisition
