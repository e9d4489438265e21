// SPDX-License-Identifier: BSD-3-Clause
#include "app/worker_processes.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <stdexcept>

#include "app/program.hpp"

namespace impactrig::app {
namespace {

constexpr std::size_t longest_sentence = 4096;  ///< what any pipe holds

struct Worker {
  std::size_t item = 0;
  int sentence = -1;  ///< pipe it is written to
};

/// SIGCHLD, SIGINT and SIGTERM wait until they are asked for.
class HeldSignals {
 public:
  HeldSignals() {
    sigemptyset(&held_);
    for (const int signal : {SIGCHLD, SIGINT, SIGTERM}) sigaddset(&held_, signal);
    sigprocmask(SIG_BLOCK, &held_, &before_);
  }

  ~HeldSignals() { release(); }

  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  int next() const {
    int signal = 0;
    while (sigwait(&held_, &signal) != 0) {
    }
    return signal;
  }

  void release() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t held_{}, before_{};
};

[[noreturn]] void be_worker(const std::function<WorkEnd(std::size_t)>& work, std::size_t item,
                            int pipe) {
  const WorkEnd end = work(item);
  // read when this process has ended, so it must fit into the pipe
  const std::string sentence = end.sentence.substr(0, longest_sentence);
  std::size_t written = 0;
  while (written < sentence.size()) {
    const ssize_t n = write(pipe, sentence.data() + written, sentence.size() - written);
    if (n <= 0) break;
    written += static_cast<std::size_t>(n);
  }
  std::fflush(nullptr);
  _exit(end.code);
}

std::string all_of(int pipe) {
  std::string out;
  std::array<char, 4096> bytes{};
  while (true) {
    const ssize_t n = read(pipe, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return out;
    out.append(bytes.data(), static_cast<std::size_t>(n));
  }
}

WorkEnd end_of(int status, std::string sentence) {
  if (WIFEXITED(status)) return {WEXITSTATUS(status), std::move(sentence)};
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return {internal_error,
          signal == SIGKILL
              ? "was ended from outside, as a system does that has no memory left; fewer --jobs "
                "need less"
              : fmt::format("the program crashed on it ({}). This is a fault of the program; "
                            "please report it with the recording",
                            strsignal(signal))};
}

class Pool {
 public:
  Pool(const std::function<WorkEnd(std::size_t)>& work,
       const std::function<void(std::size_t, const WorkEnd&)>& ended)
      : work_(work),
        ended_(ended) {}

  std::size_t size() const { return running_.size(); }

  void start(std::size_t item, const HeldSignals& signals) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe to another process can be made");
    std::fflush(nullptr);  // or both would write what is buffered
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0) throw std::runtime_error("no process can be started");
    if (process == 0) {
#ifdef __linux__
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(internal_error);
#endif
      signal(SIGINT, SIG_IGN);  // a terminal sends it to all; the parent decides
      signals.release();
      close(ends[0]);
      be_worker(work_, item, ends[1]);
    }
    close(ends[1]);
    running_[process] = {item, ends[0]};
  }

  /// Those that have ended.
  void reap() {
    for (auto at = running_.begin(); at != running_.end();) {
      int status = 0;
      if (waitpid(at->first, &status, WNOHANG) != at->first) {
        ++at;
        continue;
      }
      const Worker worker = at->second;
      at = running_.erase(at);
      std::string sentence = all_of(worker.sentence);
      close(worker.sentence);
      ended_(worker.item, end_of(status, std::move(sentence)));
    }
  }

  void stop(const std::function<void(std::size_t)>& cut) {
    for (const auto& [process, worker] : running_) kill(process, SIGKILL);
    for (const auto& [process, worker] : running_) {
      waitpid(process, nullptr, 0);
      close(worker.sentence);
      cut(worker.item);
    }
    running_.clear();
  }

 private:
  const std::function<WorkEnd(std::size_t)>& work_;
  const std::function<void(std::size_t, const WorkEnd&)>& ended_;
  std::map<pid_t, Worker> running_;
};

}  // namespace

int run_in_processes(std::size_t items, std::size_t jobs,
                     const std::function<WorkEnd(std::size_t)>& work,
                     const std::function<void(std::size_t, const WorkEnd&)>& ended,
                     const std::function<void(std::size_t)>& cut) {
  const HeldSignals signals;
  Pool pool(work, ended);
  std::size_t next = 0;
  while (next < items || pool.size() > 0) {
    while (next < items && pool.size() < jobs) pool.start(next++, signals);
    const int signal = signals.next();
    pool.reap();
    if (signal == SIGCHLD) continue;
    pool.stop(cut);
    return signal;
  }
  return 0;
}

}  // namespace impactrig::app
