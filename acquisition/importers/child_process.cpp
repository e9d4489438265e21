// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace impactrig::acquisition {

namespace {

[[noreturn]] void run(const std::function<void(const PipeWriter&)>& work, int descriptor,
                      unsigned cpu_seconds) {
  // a crash ends the child quietly: no core, and no handler of the program's
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGPIPE, SIGALRM})
    std::signal(signal, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // it does not outlive the program
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const rlimit time{cpu_seconds, cpu_seconds};
  setrlimit(RLIMIT_CPU, &time);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);  // "free(): invalid pointer" is no news for users
  try {
    work(PipeWriter(descriptor));
  } catch (...) {
    _exit(3);
  }
  _exit(0);  // nothing of the program's is run down
}

}  // namespace

void PipeWriter::bytes(const void* from, std::size_t count) const {
  const auto* at = static_cast<const char*>(from);
  while (count > 0) {
    const ssize_t done = ::write(descriptor_, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) _exit(4);
    at += done;
    count -= static_cast<std::size_t>(done);
  }
}

void PipeWriter::text(std::string_view value) const {
  number(value.size());
  bytes(value.data(), value.size());
}

ChildProcess::ChildProcess(const std::function<void(const PipeWriter&)>& work,
                           unsigned cpu_seconds) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "no pipe to a process");
  fcntl(ends[1], F_SETPIPE_SZ, 1 << 20);
  id_ = ::fork();
  if (id_ == 0) {
    ::close(ends[0]);
    run(work, ends[1], cpu_seconds);
  }
  const int problem = errno;
  ::close(ends[1]);
  descriptor_ = ends[0];
  if (id_ < 0) {
    ::close(descriptor_);
    throw std::system_error(problem, std::generic_category(), "no process to read the file in");
  }
}

ChildProcess::~ChildProcess() {
  ::close(descriptor_);
  if (id_ <= 0) return;
  ::kill(id_, SIGKILL);
  int status = 0;
  while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
}

bool ChildProcess::bytes(void* to, std::size_t count) {
  auto* at = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t done = ::read(descriptor_, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    count -= static_cast<std::size_t>(done);
  }
  return true;
}

bool ChildProcess::text(std::string& value, std::size_t most) {
  std::uint64_t size = 0;
  if (!number(size) || size > most) return false;
  value.resize(size);
  return bytes(value.data(), size);
}

std::string ChildProcess::wait() {
  int status = 0;
  while (::waitpid(id_, &status, 0) < 0)
    if (errno != EINTR) return "it is lost";
  id_ = -1;
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGKILL) return "it took too long";
    return fmt::format("it was ended by signal {}", signal);
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    return fmt::format("it failed with code {}", WEXITSTATUS(status));
  return {};
}

}  // namespace impactrig::acquisition
