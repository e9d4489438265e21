// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sndfile.h>

#include <string>
#include <vector>

#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition::tests {

/// A sound file as libsndfile writes it: rows of these channels, parts of full scale from -1 to
/// less than 1.
inline std::string sound_file(int format, int channels, int rate,
                              const std::vector<double>& samples) {
  const WrittenFile file("", ".sound");
  SF_INFO info{};
  info.format = format;
  info.channels = channels;
  info.samplerate = rate;
  SNDFILE* const sound = sf_open(file.path().c_str(), SFM_WRITE, &info);
  EXPECT_NE(sound, nullptr) << sf_strerror(nullptr);
  if (sound == nullptr) return {};
  sf_set_string(sound, SF_STR_TITLE, "run 7");
  const auto count = static_cast<sf_count_t>(samples.size());
  const int subtype = format & SF_FORMAT_SUBMASK;
  if (subtype == SF_FORMAT_FLOAT || subtype == SF_FORMAT_DOUBLE) {
    sf_write_double(sound, samples.data(), count);
  } else {  // doubles it would multiply by 127, 32767, ...
    std::vector<int> integers;
    for (const double sample : samples) integers.push_back(static_cast<int>(0x1p31 * sample));
    sf_write_int(sound, integers.data(), count);
  }
  sf_close(sound);
  return bytes_of(file.path());
}

}  // namespace impactrig::acquisition::tests
