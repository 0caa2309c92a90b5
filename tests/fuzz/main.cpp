// SPDX-License-Identifier: Apache-2.0
// aureole_fuzz: damages scenes and looks whether each of them ends in a picture or in located errors.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/error.h"
#include "fuzz/corpus.h"
#include "fuzz/fuzz_case.h"
#include "fuzz/run_case.h"
#include "fuzz/self_test.h"
#include "fuzz/supervisor.h"
#include "harness/paths.h"

#if defined(__SANITIZE_ADDRESS__)
/// OpenVDB 10 loses a buffer of its own where a damaged file ends within a node; not ours to free.
extern "C" const char* __lsan_default_suppressions() { return "leak:libopenvdb\n"; }
#endif

namespace aureole::fuzz {
namespace {

constexpr const char* kVerdicts[] = {"pictures", "refused with located errors", "too large to render here",
                                     "too slow to render here", "FAILED"};

struct Arguments {
  std::uint64_t cases = 1000, seed = 1, first = 0;
  std::int64_t single = -1;
  int jobs = 2;
  std::size_t most_failures = 100;
  std::filesystem::path folder = "fuzz", corpus_folder, regressions;
  bool self_test = false, check_corpus = false, help = false;
};

std::string description(const Case& c) {
  std::string text = "made from: " + c.base + "\n";
  for (const std::string& m : c.mutations) text += "  " + m + "\n";
  if (!c.options.sampler.empty()) text += "  --sampler " + c.options.sampler + "\n";
  if (!c.options.integrator.empty()) text += "  --integrator " + c.options.integrator + "\n";
  if (c.options.sample_count) text += fmt::format("  --spp {}\n", *c.options.sample_count);
  for (const auto& [name, value] : c.options.defines) text += "  -D " + name + "=" + value + "\n";
  return text;
}

/// One case in this process, for a debugger.
int replay(const Corpus& corpus, const Arguments& a) {
  const Case c = make_case(corpus, a.seed, std::uint64_t(a.single));
  const std::filesystem::path folder = std::filesystem::absolute(a.folder / fmt::format("case-{}", a.single));
  write_case(c, folder);
  fmt::print("{}{}\n", description(c), (folder / kMainFile).string());
  std::fflush(stdout);
  const Verdict v = run_case(c, folder);
  fmt::print("{}{}\n{}", kVerdicts[v.kind],
             v.invalid_samples ? fmt::format(", {} invalid samples", v.invalid_samples) : "", v.message);
  return v.kind == Verdict::failed;
}

/// Scenes that do not load as they are find few errors: says which.
int check_corpus(const Corpus& corpus, const Arguments& a) {
  int bad = 0;
  for (const BaseScene& scene : corpus.scenes()) {
    const Case c{scene.name, {}, scene.files, {}};
    const std::filesystem::path folder = std::filesystem::absolute(a.folder / "corpus");
    write_case(c, folder);
    const auto start = std::chrono::steady_clock::now();
    const Verdict v = run_case(c, folder);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print("{:6.0f} ms  {}: {}\n{}", seconds * 1e3, scene.name, kVerdicts[v.kind], v.message);
    bad += v.kind != Verdict::picture;
  }
  fmt::print("{} of {} scenes do not become a picture\n", bad, corpus.scenes().size());
  return bad > 0;
}

/// Every scene in a folder of its own, for tools/picture_hashes.py.
int write_corpus(const Corpus& corpus, const std::filesystem::path& folder) {
  std::map<std::string, int> times;  // names repeat: an example may be wrapped in two ways
  for (const BaseScene& scene : corpus.scenes()) {
    std::string name = scene.name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || c == ' '; }, '_');
    if (const int n = ++times[name]; n > 1) name += fmt::format("_{}", n);
    write_case(Case{scene.name, {}, scene.files, {}}, std::filesystem::absolute(folder / name));
  }
  return 0;
}

/// Cases that failed once, one in each subfolder: `kMainFile` and what it refers to.
int run_regressions(const Arguments& a) {
  std::vector<Case> cases;
  for (const auto& entry : std::filesystem::directory_iterator(a.regressions)) {
    if (!entry.is_directory()) continue;
    Case& c = cases.emplace_back();
    c.base = entry.path().filename().string();
    for (const auto& file : std::filesystem::directory_iterator(entry.path()))
      c.files[file.path().filename().string()] = std::make_shared<const std::string>(read_whole(file.path()));
  }
  const Supervisor::Run run = [&](std::uint64_t index, const std::filesystem::path& where) {
    write_case(cases[index], where);
    return run_case(cases[index], where);
  };
  const auto report = [&](const Failure& f) { fmt::print("{}: {}\n{}", cases[f.index].base, f.what, f.log); };
  Supervisor supervisor(run, Limits{}, a.jobs, std::filesystem::absolute(a.folder));
  const Summary s = supervisor.run(0, cases.size(), cases.size() + 1, report);
  fmt::print("{} of {} cases that failed once fail\n", s.failures.size(), cases.size());
  return !s.failures.empty() || cases.empty();
}

int fuzz(const Corpus& corpus, const Arguments& a) {
  const auto folder = std::filesystem::absolute(a.folder);
  const Supervisor::Run run = [&](std::uint64_t index, const std::filesystem::path& where) {
    const Case c = make_case(corpus, a.seed, index);
    write_case(c, where);
    return run_case(c, where);
  };
  const auto report = [&](const Failure& f) {
    const auto kept = folder / fmt::format("failure-{}-{}", a.seed, f.index);
    const Case c = make_case(corpus, a.seed, f.index);
    write_case(c, kept);
    std::ofstream(kept / "report.txt") << f.what << "\n" << description(c) << f.log;
    fmt::print("case {}: {}\n  aureole_fuzz --seed {} --case {}    files: {}\n", f.index, f.what, a.seed,
               f.index, kept.string());
    std::fflush(stdout);
  };
  fmt::print("seed {}, cases {} to {}, from {} scenes and {} data files\n", a.seed, a.first,
             a.first + a.cases - 1, corpus.scenes().size(), corpus.data_files().size());
  std::fflush(stdout);
  const auto start = std::chrono::steady_clock::now();
  Supervisor supervisor(run, Limits{}, a.jobs, folder);
  const Summary s = supervisor.run(a.first, a.first + a.cases, a.most_failures, report);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (std::size_t k = 0; k < Verdict::kinds; ++k) fmt::print("{:8} {}\n", s.count[k], kVerdicts[k]);
  fmt::print("{:8} of the pictures with invalid samples, which are left out", s.with_invalid_samples);
  for (std::size_t k = 0; k < std::min<std::size_t>(s.invalid.size(), 20); ++k)
    fmt::print("{}{}", k ? ", " : " (cases ", s.invalid[k]);
  fmt::print("{}\n", s.invalid.empty() ? "" : ")");
  fmt::print("{:.1f} s; the slowest case is {} ({:.2f} s)\n", seconds, s.slowest, s.slowest_seconds);
  std::map<std::string, std::vector<std::uint64_t>> by_kind;
  for (const Failure& f : s.failures) by_kind[f.what].push_back(f.index);
  for (const auto& [what, cases] : by_kind)
    fmt::print("{} x {} (case {})\n", cases.size(), what, cases.front());
  return !s.failures.empty();
}

constexpr const char* kHelp =
    "aureole_fuzz: damages the scenes of the repository in random ways, loads and renders them\n"
    "  --cases N          number of cases (default 1000)\n"
    "  --seed N           another seed makes other cases (default 1)\n"
    "  --first N          number of the first case (default 0)\n"
    "  --case N           run this case alone, in this process, and print how it ends\n"
    "  --jobs N           processes at a time (default 2)\n"
    "  --folder PATH      for the files of cases that fail (default fuzz)\n"
    "  --most-failures N  stop after so many (default 100)\n"
    "  --check-corpus     load the scenes without changing them\n"
    "  --regressions PATH   run the cases in the subfolders of this folder instead\n"
    "  --write-corpus PATH  write the unchanged scenes into this folder\n"
    "  --self-test        plant a crash, a hang, ... and look whether they are found\n";

template <class T>
T number(std::string_view option, std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < T(0))
    throw Error(fmt::format("{}: \"{}\" is not a whole number from 0 on", option, text));
  return value;
}

/// Read by hand: CLI11 takes longer to compile than the rest of the fuzzer.
Arguments arguments(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    const auto value = [&]() -> std::string_view {
      if (++i == argc) throw Error(fmt::format("{}: no value", option));
      return argv[i];
    };
    if (option == "--cases")
      a.cases = number<std::uint64_t>(option, value());
    else if (option == "--seed")
      a.seed = number<std::uint64_t>(option, value());
    else if (option == "--first")
      a.first = number<std::uint64_t>(option, value());
    else if (option == "--case")
      a.single = number<std::int64_t>(option, value());
    else if (option == "--jobs")
      a.jobs = number<int>(option, value());
    else if (option == "--folder")
      a.folder = value();
    else if (option == "--most-failures")
      a.most_failures = number<std::size_t>(option, value());
    else if (option == "--check-corpus")
      a.check_corpus = true;
    else if (option == "--write-corpus")
      a.corpus_folder = value();
    else if (option == "--regressions")
      a.regressions = value();
    else if (option == "--self-test")
      a.self_test = true;
    else if (option == "--help")
      a.help = true;
    else
      throw Error(fmt::format("unknown option \"{}\"\n{}", option, kHelp));
  }
  return a;
}

int run(const Arguments& a) {
  if (a.help) {
    fmt::print("{}", kHelp);
    return 0;
  }
  if (a.self_test) return self_test(a.folder);
  if (!a.regressions.empty()) return run_regressions(a);
  const Corpus corpus(aureole::test::source_dir());
  if (!a.corpus_folder.empty()) return write_corpus(corpus, a.corpus_folder);
  if (a.check_corpus) return check_corpus(corpus, a);
  return a.single >= 0 ? replay(corpus, a) : fuzz(corpus, a);
}

}  // namespace
}  // namespace aureole::fuzz

int main(int argc, char** argv) {
  try {
    return aureole::fuzz::run(aureole::fuzz::arguments(argc, argv));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
