// SPDX-License-Identifier: BSD-3-Clause
// How fast recordings are read, against a plain loop that reads the same file and converts its
// numbers. One core, files in the page cache, both in one run, alternating. With --program also how
// long that program's import to HDF5 takes by the clock, beside copying the file.
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/os.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "acquisition/importer.hpp"
#include "bench/timing.hpp"
#include "datasets/record_writer.hpp"

namespace {

using namespace impactrig;
namespace fs = std::filesystem;

double sample(std::size_t i) {
  return 100.0 * std::sin(1e-3 * static_cast<double>(i)) + 1e-3 * static_cast<double>(i % 977);
}

// ---- files of a given size, one a format ----

void write_csv(const std::string& path, std::size_t bytes) {
  auto file = fmt::output_file(path);
  file.print("Time [s],Force [N],Velocity [m/s]\n");
  for (std::size_t i = 0, written = 0; written < bytes; ++i) {
    const std::string line = fmt::format("{:.7f},{:.6f},{:.6e}\n", 1e-6 * static_cast<double>(i),
                                         sample(i), sample(3 * i));
    written += line.size();
    file.print("{}", line);
  }
}

std::string uff58_head(std::string_view identifier, std::size_t points) {
  return fmt::format(
      "    -1\n{:<80}\nForce\nNONE\n01-Jan-20 10:00:00\nNONE\nNONE\n"
      "    1         0    0         0       NONE         1   3       NONE         1   3\n"
      "         2{:10}         1  0.00000E+00  1.00000E-06  0.00000E+00\n"
      "        17    0    0    0                 Time                    s\n"
      "        13    0    0    0                Force                    N\n"
      "         0    0    0    0                 NONE                 NONE\n"
      "         0    0    0    0                 NONE                 NONE\n",
      identifier, points);
}

void write_uff58(const std::string& path, std::size_t bytes) {
  const std::size_t lines = bytes / 79;
  auto file = fmt::output_file(path);
  file.print("{}", uff58_head("    58", 6 * lines));
  for (std::size_t i = 0; i < 6 * lines; i += 6)
    file.print("{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", sample(i), sample(i + 1),
               sample(i + 2), sample(i + 3), sample(i + 4), sample(i + 5));
  file.print("    -1\n");
}

void write_uff58b(const std::string& path, std::size_t bytes) {
  const std::size_t points = bytes / 4;
  std::ofstream file(path, std::ios::binary);
  file << uff58_head(fmt::format("    58b     1     2          11{:12}     0     0           0"
                                 "           0",
                                 4 * points),
                     points);
  std::vector<float> block(65536);
  for (std::size_t i = 0; i < points; i += block.size()) {
    for (std::size_t k = 0; k < block.size(); ++k) block[k] = static_cast<float>(sample(i + k));
    const std::size_t count = std::min(block.size(), points - i);
    file.write(reinterpret_cast<const char*>(block.data()),
               static_cast<std::streamsize>(4 * count));
  }
  file << "    -1\n";
}

/// Little-endian numbers and texts one after another.
class Bytes {
 public:
  template <typename Number>
  void number(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  void text(std::string_view text) { bytes_ += text; }

  void counted(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }

  const std::string& all() const { return bytes_; }

 private:
  std::string bytes_;
};

template <typename Number>
void write_samples(std::ofstream& file, std::size_t samples) {
  std::vector<Number> block(65536);
  for (std::size_t i = 0; i < samples; i += block.size()) {
    for (std::size_t k = 0; k < block.size(); ++k) block[k] = static_cast<Number>(sample(i + k));
    file.write(reinterpret_cast<const char*>(block.data()),
               static_cast<std::streamsize>(sizeof(Number) * std::min(block.size(), samples - i)));
  }
}

/// One segment with eight channels, one after another or interleaved.
template <typename Number, std::uint32_t type, bool interleaved>
void write_tdms(const std::string& path, std::size_t bytes) {
  constexpr std::size_t channels = 8;
  const std::uint64_t samples = bytes / sizeof(Number) / channels;
  Bytes objects;
  objects.number(std::uint32_t{channels});
  for (std::size_t c = 0; c < channels; ++c) {
    objects.counted(fmt::format("/'shot'/'channel {}'", c));
    objects.number(std::uint32_t{20});
    objects.number(type);
    objects.number(std::uint32_t{1});
    objects.number(samples);
    objects.number(std::uint32_t{1});
    objects.counted("wf_increment");
    objects.number(std::uint32_t{10});
    objects.number(1e-6);
  }
  Bytes lead;
  lead.text("TDSm");
  lead.number(std::uint32_t{interleaved ? 0x2EU : 0x0EU});
  lead.number(std::uint32_t{4713});
  lead.number(std::uint64_t{objects.all().size() + samples * channels * sizeof(Number)});
  lead.number(std::uint64_t{objects.all().size()});
  std::ofstream file(path, std::ios::binary);
  file << lead.all() << objects.all();
  write_samples<Number>(file, samples * channels);
}

void write_wav(const std::string& path, std::size_t bytes) {
  const auto data = static_cast<std::uint32_t>(bytes / 4 * 4);
  Bytes head;
  head.text("RIFF");
  head.number(std::uint32_t{36 + data});
  head.text("WAVEfmt ");
  head.number(std::uint32_t{16});
  head.number(std::uint16_t{1});  // PCM
  head.number(std::uint16_t{2});
  head.number(std::uint32_t{48000});
  head.number(std::uint32_t{48000 * 4});
  head.number(std::uint16_t{4});
  head.number(std::uint16_t{16});
  head.text("data");
  head.number(data);
  std::ofstream file(path, std::ios::binary);
  file << head.all();
  write_samples<std::int16_t>(file, data / 2);
}

/// Our own file, as `import` writes it.
void write_hdf5(const std::string& path, std::size_t bytes) {
  datasets::RecordWriter writer(path, {"Force"});
  std::vector<float> block(65536);
  for (std::size_t i = 0; i < bytes / 4; i += block.size()) {
    for (std::size_t k = 0; k < block.size(); ++k) block[k] = static_cast<float>(sample(i + k));
    writer.append(0, std::span<const float>(block));
  }
  datasets::Record record;
  record.channels.resize(1);
  record.channels[0].name = "Force";
  record.channels[0].clock.interval = 1e-6;
  writer.finish(record);
}

// ---- yardsticks: read pieces that stay in the cache, convert and sum, nothing else ----

/// Eight sums side by side, so that the addition costs as little as the conversion.
double sum_of(const std::vector<double>& values) {
  std::array<double, 8> sums{};
  const std::size_t whole = values.size() / 8 * 8;
  for (std::size_t i = 0; i < whole; i += 8)
    for (std::size_t k = 0; k < 8; ++k) sums[k] += values[i + k];
  for (std::size_t i = whole; i < values.size(); ++i) sums[0] += values[i];
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Reads a file piece by piece; `use` is handed the pieces.
template <typename Use>
void read_by_pieces(const std::string& path, const Use& use) {
  const int file = open(path.c_str(), O_RDONLY);
  std::vector<char> piece(1U << 17);
  for (ssize_t count = 0; (count = read(file, piece.data(), piece.size())) > 0;)
    use(piece.data(), static_cast<std::size_t>(count));
  close(file);
}

template <typename Number>
double read_binary(const std::string& path) {
  double sum = 0.0;
  std::vector<double> values;
  read_by_pieces(path, [&](const char* bytes, std::size_t count) {
    const std::size_t n = count / sizeof(Number);
    values.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      Number number;
      std::memcpy(&number, bytes + i * sizeof(Number), sizeof(Number));
      values[i] = 1.0 * static_cast<double>(number) + 0.0;
    }
    sum += sum_of(values);
  });
  return sum;
}

/// Numbers wherever they begin, by the standard library's std::from_chars; those that a piece's end
/// cuts are lost, it is a yardstick.
double read_text(const std::string& path) {
  double sum = 0.0;
  read_by_pieces(path, [&sum](const char* at, std::size_t count) {
    const char* const end = at + count;
    while (at != end) {
      double value = 0.0;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error == std::errc{}) sum += value;
      at = next == at ? at + 1 : next;
    }
  });
  return sum;
}

// ---- ours ----

/// Samples in their unit, summed: what the yardstick does with its numbers.
class Sum final : public acquisition::SampleSink {
 public:
  explicit Sum(const acquisition::RecordingHead& head) : head_(head) {}

  void take(std::size_t channel, const acquisition::SampleBlock& block) override {
    const double scale = head_.record.channels[channel].scale;
    const double offset = head_.record.channels[channel].offset;
    values_.resize(block.size());
    std::visit(
        [&](auto samples) {
          for (std::size_t i = 0; i < samples.size(); ++i)
            values_[i] = scale * static_cast<double>(samples[i]) + offset;
        },
        block.raw);
    sum += sum_of(values_);
  }

  void take_times(std::size_t, std::span<const double> times) override {
    for (const double time : times) sum += time;
  }

  double sum = 0.0;

 private:
  const acquisition::RecordingHead& head_;
  std::vector<double> values_;
};

double read_with_impactrig(const std::string& path) {
  const auto reader = acquisition::open_recording(path);
  Sum sum(reader->head());
  reader->read({}, sum);
  return sum.sum;
}

struct Format {
  std::string name;
  std::string ending;
  void (*write)(const std::string& path, std::size_t bytes);
  double (*yardstick)(const std::string& path);
};

const std::vector<Format> formats = {
    {"csv", ".csv", write_csv, read_text},
    {"uff58", ".uff", write_uff58, read_text},
    {"uff58b", ".uff", write_uff58b, read_binary<float>},
    {"tdms", ".tdms", write_tdms<float, 9, false>, read_binary<float>},
    {"tdms-16", ".tdms", write_tdms<std::int16_t, 2, false>, read_binary<std::int16_t>},
    {"tdms-rows", ".tdms", write_tdms<float, 9, true>, read_binary<float>},
    {"wav", ".wav", write_wav, read_binary<std::int16_t>},
    {"our-hdf5", ".h5", write_hdf5, read_binary<float>},
};

/// The quickest of `rounds`, alternating so that both see the same machine. [s]
struct Pair {
  double ours = std::numeric_limits<double>::infinity();
  double yardstick = std::numeric_limits<double>::infinity();
  double opening = std::numeric_limits<double>::infinity();
  double import = std::numeric_limits<double>::infinity();  ///< by the clock, all threads
  double digest = std::numeric_limits<double>::infinity();  ///< SHA-256 alone, by the clock
  double copy = std::numeric_limits<double>::infinity();    ///< by the clock
};

/// By the clock. [s]
template <typename Call>
double seconds_of(const Call& call) {
  const auto started = std::chrono::steady_clock::now();
  call();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - started;
  return passed.count();
}

/// What a user waits for, start of the program included. [s]
double import_seconds(const std::string& program, const std::string& path) {
  const std::string output = path + ".imported.h5";
  fs::remove(output);
  const std::string command =
      fmt::format("'{}' import '{}' -o '{}' --quiet > /dev/null 2>&1", program, path, output);
  int failed = 0;
  const double seconds = seconds_of([&] { failed = std::system(command.c_str()); });
  fs::remove(output);
  if (failed != 0) throw std::runtime_error(fmt::format("'{}' failed", command));
  return seconds;
}

double copy_seconds(const std::string& path) {
  const std::string output = path + ".copy";
  const double seconds = seconds_of([&] { fs::copy_file(path, output); });
  fs::remove(output);
  return seconds;
}

Pair measure(const Format& format, const std::string& path, int rounds,
             const std::string& program) {
  Pair best;
  double kept = 0.0;
  const auto timed = [&kept](double& quickest, const auto& call) {
    const double started = bench::processor_seconds();
    kept += call();
    quickest = std::min(quickest, bench::processor_seconds() - started);
  };
  for (int round = 0; round < rounds; ++round) {
    timed(best.yardstick, [&] { return format.yardstick(path); });
    timed(best.ours, [&] { return read_with_impactrig(path); });
    timed(best.opening, [&] {
      return static_cast<double>(acquisition::open_recording(path)->head().samples.size());
    });
    if (program.empty()) continue;
    best.import = std::min(best.import, import_seconds(program, path));
    best.digest = std::min(best.digest, seconds_of([&] { datasets::sha256_of_file(path); }));
    best.copy = std::min(best.copy, copy_seconds(path));
  }
  volatile double used = kept;  // so that nothing is optimised away
  static_cast<void>(used);
  return best;
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App program{"Import throughput of each format against a plain read-and-convert loop"};
  std::size_t megabytes = 200;
  int rounds = 5;
  std::string output;
  std::string folder = fs::temp_directory_path();
  std::string importer;
  std::vector<std::string> names;
  program.add_option("--megabytes", megabytes, "Size of each file")->capture_default_str();
  program.add_option("--rounds", rounds, "The quickest of so many counts")->capture_default_str();
  program.add_option("--folder", folder, "Where the files are made")->capture_default_str();
  program.add_option("--program", importer, "Measures this program's import to HDF5 as well");
  program.add_option("-o,--output", output, "Figures (JSON)");
  program.add_option("format", names, "Formats; default: all");
  CLI11_PARSE(program, count, arguments);

  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  fmt::print("{:<12}{:>8}{:>12}{:>16}{:>8}{:>12}{:>13}{:>13}{:>11}\n", "format", "MB", "ours MB/s",
             "yardstick MB/s", "ratio", "opening ms", "import MB/s", "SHA-256 MB/s", "copy MB/s");
  for (const Format& format : formats) {
    if (!names.empty() && std::ranges::find(names, format.name) == names.end()) continue;
    const std::string path = folder + "/impactrig_speed_" + format.name + format.ending;
    format.write(path, megabytes * 1000000);
    const double size = 1e-6 * static_cast<double>(fs::file_size(path));
    const Pair best = measure(format, path, rounds, importer);
    fs::remove(path);
    fmt::print("{:<12}{:>8.0f}{:>12.0f}{:>16.0f}{:>8.2f}{:>12.2f}{:>13.0f}{:>13.0f}{:>11.0f}\n",
               format.name, size, size / best.ours, size / best.yardstick,
               best.yardstick / best.ours, 1e3 * best.opening, size / best.import,
               size / best.digest, size / best.copy);
    table.push_back({{"format", format.name},
                     {"megabytes", size},
                     {"megabytes_per_s", size / best.ours},
                     {"yardstick_megabytes_per_s", size / best.yardstick},
                     {"opening_s", best.opening}});
    if (!importer.empty()) {
      table.back()["import_megabytes_per_s"] = size / best.import;
      table.back()["sha256_megabytes_per_s"] = size / best.digest;
      table.back()["copy_megabytes_per_s"] = size / best.copy;
    }
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("largest memory {:.0f} MB\n", 1e-3 * static_cast<double>(usage.ru_maxrss));
  if (!output.empty()) std::ofstream(output) << table.dump(2) << '\n';
}
