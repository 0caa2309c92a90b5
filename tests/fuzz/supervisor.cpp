// SPDX-License-Identifier: Apache-2.0
#include "fuzz/supervisor.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <deque>
#include <fstream>
#include <optional>
#include <thread>

#include "fuzz/crash_log.h"

namespace aureole::fuzz {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kBatch = 50;
constexpr int kFailedExit = 77;  ///< of a child whose case failed

struct Range {
  std::uint64_t begin, end;
  bool again = false;  ///< only to search for leaks: the cases have been counted
};

/// Progress of a child process, in memory shared with its parent, which survives the child.
struct Progress {
  std::atomic<std::uint64_t> index, invalid_samples, first_invalid, slowest;
  std::atomic<double> cpu_at_start, slowest_seconds;
  std::atomic<bool> finished;  ///< all cases done; what comes now is the search for leaks
  std::atomic<std::uint64_t> count[Verdict::kinds];
  char message[1 << 14];
};

struct Child {
  pid_t pid = 0;
  Range range{};
  Progress* progress = nullptr;
  fs::path folder, log;
  std::chrono::steady_clock::time_point case_since;
  std::uint64_t case_seen = 0;
  std::string killed_for;
};

double cpu_seconds_of(pid_t pid) {
  std::ifstream in(fmt::format("/proc/{}/stat", pid));
  std::string text{std::istreambuf_iterator<char>(in), {}};
  // Fields 14 and 15, counted behind the name in parentheses, which may hold anything.
  const std::size_t at = text.rfind(')');
  unsigned long user = 0, system = 0;
  if (at == std::string::npos ||
      std::sscanf(text.c_str() + at, ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user,
                  &system) != 2)
    return 0;
  return double(user + system) / double(sysconf(_SC_CLK_TCK));
}

double resident_bytes(pid_t pid) {
  std::ifstream in(fmt::format("/proc/{}/statm", pid));
  double all = 0, resident = 0;
  in >> all >> resident;
  return resident * double(sysconf(_SC_PAGESIZE));
}

double own_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// noexcept: what a case throws must end this process alone. Caught further up it would destroy the supervisor's
/// data, which ends the other children.
[[noreturn]] void run_child(const Child& c, const Supervisor::Run& run) noexcept {
  const int log = open(c.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  dup2(log, 1), dup2(log, 2);
  // Sanitizers reserve terabytes of address space: with them only the parent's check of resident memory
  // applies.
  const rlimit address_space{rlim_t(8) << 30, rlim_t(8) << 30};
  if (!kSanitized) setrlimit(RLIMIT_AS, &address_space);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  log_crashes();
  Progress& p = *c.progress;
  for (std::uint64_t i = c.range.begin; i < c.range.end; ++i) {
    const double start = own_cpu_seconds();
    p.cpu_at_start = start;
    p.index = i;
    const Verdict v = run(i, c.folder);
    if (v.kind == Verdict::failed) {
      std::snprintf(p.message, sizeof p.message, "%s", v.message.c_str());
      _exit(kFailedExit);
    }
    ++p.count[v.kind];
    if (v.invalid_samples > 0 && p.invalid_samples++ == 0) p.first_invalid = i;
    if (const double seconds = own_cpu_seconds() - start; seconds > p.slowest_seconds)
      p.slowest_seconds = seconds, p.slowest = i;
  }
  p.finished = true;
  std::exit(0);  // not _exit: leaks are looked for at the end
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// The line of a sanitizer's report that says most, or an empty string.
std::string report_line(const std::string& log) {
  for (const char* mark : {"SUMMARY: ", "runtime error: ", "ERROR: "})
    if (const std::size_t at = log.find(mark); at != std::string::npos) {
      const std::size_t begin = log.rfind('\n', at) + 1;
      return first_line(log.substr(begin));
    }
  return "";
}

class Pool {
public:
  Pool(const Supervisor::Run& run, const Limits& limits, int jobs, const fs::path& folder,
       std::size_t most_failures, const std::function<void(const Failure&)>& report)
      : run_(run),
        limits_(limits),
        most_failures_(most_failures),
        report_(report),
        children_(std::size_t(jobs)) {
    for (std::size_t k = 0; k < children_.size(); ++k) {
      Child& c = children_[k];
      c.folder = folder / fmt::format("child{}", k);
      c.log = folder / fmt::format("child{}.log", k);
      void* shared =
          mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
      if (shared == MAP_FAILED) throw std::runtime_error("no shared memory");
      c.progress = new (shared) Progress{};
    }
  }
  ~Pool() {
    for (Child& c : children_) {
      if (c.pid) kill(c.pid, SIGKILL), waitpid(c.pid, nullptr, 0);
      munmap(c.progress, sizeof(Progress));
    }
  }

  void work(std::deque<Range> ranges) {
    ranges_ = std::move(ranges);
    for (;;) {
      bool any = false;
      const bool enough = summary.failures.size() >= most_failures_;
      for (Child& c : children_) {
        if (c.pid) look_after(c);
        if (!c.pid && !ranges_.empty() && !enough) start(c);
        any |= c.pid != 0;
      }
      if (!any) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  Summary summary;

private:
  void start(Child& c) {
    c.range = ranges_.front();
    ranges_.pop_front();
    c.killed_for.clear();
    c.case_since = std::chrono::steady_clock::now();
    c.case_seen = c.range.begin;
    Progress& p = *c.progress;
    p.index = c.range.begin;
    p.invalid_samples = p.first_invalid = p.slowest = 0;
    p.cpu_at_start = p.slowest_seconds = 0;
    p.finished = false;
    for (auto& n : p.count) n = 0;
    p.message[0] = 0;
    c.pid = fork();
    if (c.pid < 0) throw std::runtime_error("fork failed");
    if (c.pid == 0) run_child(c, run_);
  }

  void look_after(Child& c) {
    int status = 0;
    if (waitpid(c.pid, &status, WNOHANG) == c.pid) {
      c.pid = 0;
      ended(c, status);
      return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (const std::uint64_t index = c.progress->index; index != c.case_seen)
      c.case_seen = index, c.case_since = now;
    const double wall = std::chrono::duration<double>(now - c.case_since).count();
    if (!c.killed_for.empty()) {
      if (wall > 20) kill(c.pid, SIGKILL);  // it was asked to end, for its stack; that did not work
      return;
    }
    const double bytes = resident_bytes(c.pid);
    if (bytes > limits_.bytes) c.killed_for = fmt::format("{:.1f} GiB of memory", bytes / (1 << 30));
    // Wall time is read more often than it matters.
    if (wall > 1 && cpu_seconds_of(c.pid) - c.progress->cpu_at_start > limits_.seconds)
      c.killed_for = fmt::format("no end after {} s of processor time", limits_.seconds);
    if (wall > limits_.wall_seconds) c.killed_for = fmt::format("no end after {} s", limits_.wall_seconds);
    if (c.killed_for.empty()) return;
    c.case_since = now;
    kill(c.pid, SIGABRT);
  }

  void ended(Child& c, int status) {
    Progress& p = *c.progress;
    const std::uint64_t index = p.index;
    const bool good_exit = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (!c.range.again) count(p);
    if (p.finished && WIFEXITED(status) && !good_exit) return found_leak(c);
    if (p.finished && good_exit) return;

    std::ifstream in(c.log, std::ios::binary);
    Failure f{index, "", std::string{std::istreambuf_iterator<char>(in), {}}};
    if (!c.killed_for.empty())
      f.what = c.killed_for;
    else if (WIFEXITED(status) && WEXITSTATUS(status) == kFailedExit)
      f.what = first_line(p.message), f.log += p.message;
    else if (const std::string line = report_line(f.log); !line.empty())
      f.what = line;
    else if (WIFSIGNALED(status))
      f.what = fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    else
      f.what = fmt::format("exit code {}", WEXITSTATUS(status));
    add(f);
    if (index + 1 < c.range.end) ranges_.push_front({index + 1, c.range.end, c.range.again});
    // The cases before it were not searched for leaks.
    if (kFindsLeaks && index > c.range.begin) ranges_.push_back({c.range.begin, index, true});
  }

  /// The search for leaks comes at the end of a child: halves find the case.
  void found_leak(const Child& c) {
    const std::uint64_t n = c.range.end - c.range.begin;
    if (n > 1) {
      ranges_.push_front({c.range.begin + n / 2, c.range.end, true});
      ranges_.push_front({c.range.begin, c.range.begin + n / 2, true});
      return;
    }
    std::ifstream in(c.log, std::ios::binary);
    Failure f{c.range.begin, "", std::string{std::istreambuf_iterator<char>(in), {}}};
    f.what = report_line(f.log);
    if (f.what.empty()) f.what = "a leak";
    add(f);
  }

  void count(const Progress& p) {
    for (std::size_t k = 0; k < Verdict::kinds; ++k) summary.count[k] += p.count[k];
    summary.with_invalid_samples += p.invalid_samples;
    if (p.invalid_samples > 0) summary.invalid.push_back(p.first_invalid);
    if (p.slowest_seconds > summary.slowest_seconds)
      summary.slowest_seconds = p.slowest_seconds, summary.slowest = p.slowest;
  }

  void add(const Failure& f) {
    for (const Failure& known : summary.failures)
      if (known.index == f.index) return;
    ++summary.count[Verdict::failed];
    summary.failures.push_back(f);
    report_(f);
  }

  const Supervisor::Run& run_;
  const Limits& limits_;
  std::size_t most_failures_;
  const std::function<void(const Failure&)>& report_;
  std::vector<Child> children_;
  std::deque<Range> ranges_;
};

}  // namespace

Summary Supervisor::run(std::uint64_t begin, std::uint64_t end, std::size_t most_failures,
                        const std::function<void(const Failure&)>& report) {
  fs::create_directories(folder_);
  std::deque<Range> ranges;
  for (std::uint64_t i = begin; i < end; i += kBatch) ranges.push_back({i, std::min(i + kBatch, end)});
  Pool pool(run_, limits_, jobs_, folder_, most_failures, report);
  pool.work(std::move(ranges));
  return std::move(pool.summary);
}

}  // namespace aureole::fuzz
