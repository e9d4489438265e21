// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace impactrig::acquisition {

/// The end of a pipe that a child process writes to. What does not go through ends the child.
class PipeWriter {
 public:
  explicit PipeWriter(int descriptor) : descriptor_(descriptor) {}

  void bytes(const void* from, std::size_t count) const;

  void number(std::uint64_t value) const { bytes(&value, sizeof value); }

  void real(double value) const { bytes(&value, sizeof value); }

  void text(std::string_view value) const;

 private:
  int descriptor_;
};

/// Runs `work` in a child process, a copy of this one, and reads what it writes: a library that
/// does not survive damaged files ends the child and not the program. The child may use `work`'s
/// memory and write to its pipe and nothing else of the program; it has `cpu_seconds` of time.
class ChildProcess {
 public:
  /// Throws std::system_error when there can be no further process.
  ChildProcess(const std::function<void(const PipeWriter&)>& work, unsigned cpu_seconds);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// False when the child has ended before it wrote that much.
  bool bytes(void* to, std::size_t count);

  bool number(std::uint64_t& value) { return bytes(&value, sizeof value); }

  bool real(double& value) { return bytes(&value, sizeof value); }

  /// False also for a text longer than `most`.
  bool text(std::string& value, std::size_t most);

  /// Waits for the child. How it ended: "" = as it should.
  std::string wait();

 private:
  pid_t id_ = -1;
  int descriptor_ = -1;
};

}  // namespace impactrig::acquisition
