// The golden runner: computes every case with this library and compares with the published implementations.
//
//     motionlang_golden [-v] [-t THREADS] [folder or folder/case ...]
//
// Cases lie in $MOTIONLANG_GOLDEN (default: the project's tests/golden/cases), one folder for each topic; without
// arguments all are run. One line for each case and variant: largest error relative to its tolerance (at most 1
// passes), and the output that has it; -v lists every output. Exit status 0 only if everything passed.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include <motionlang/core/parallel.hpp>

#include "golden.hpp"

namespace {

namespace fs = std::filesystem;
namespace ml = motionlang;

struct Tally {
  int passed = 0, failed = 0, skipped = 0;
  std::size_t cases = 0;  // that are done
};
/// One that is shared with processes that fork from this one.
Tally& shared_tally() {
  void* memory = mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return *new (memory) Tally;
}

void print_line(const char* verdict, const golden::Case& c, const std::string& variant, const std::string& remark) {
  std::printf("%-4s %-44s %-20s %s\n", verdict, c.name().c_str(), variant.c_str(), remark.c_str());
}

void run_variant(golden::Case& c, const std::string& variant, const golden::Handler& handler, bool verbose,
                 Tally& tally) {
  c.begin_variant();
  std::string failure;
  try {
    handler(c);
  } catch (const std::exception& e) {
    failure = e.what();
  }
  const auto all = c.finish();
  std::string worst_name;
  double worst = -1;
  for (const auto& r : all) {
    if (r.failure.empty() && r.ratio > worst) worst = r.ratio, worst_name = r.name;
    if (!r.failure.empty() && failure.empty()) failure = r.name + " " + r.failure;
  }
  const bool ok = failure.empty() && worst <= 1;
  ++(ok ? tally.passed : tally.failed);
  std::string remark = !failure.empty() ? failure : ml::concat_text(worst_name, " ", float(worst), " of its tolerance");
  if (c.left_out() > 0) remark += ml::concat_text("; ", c.left_out(), " outputs left out, see README.md");
  print_line(ok ? "ok" : "FAIL", c, variant, remark);
  if (verbose) {
    for (const auto& r : all) {
      std::printf("       %-40s error %-12.3g of tolerance %-10.3g %s\n", r.name.c_str(), r.error, r.ratio,
                  r.failure.c_str());
    }
  }
}

bool is_single(const std::string& variant) { return variant.find("float") != std::string::npos; }

void run_case(const fs::path& path, bool verbose, Tally& tally) {
  try {
    golden::Case c(path);
    const auto entry = golden::registry().find(c.function());
    if (entry == golden::registry().end()) {
      print_line("FAIL", c, "-", "unknown function '" + c.function() + "'");
      ++tally.failed;
      return;
    }
    const bool in_double =
        c.in_double() && std::ranges::any_of(entry->second, [](const auto& v) { return !is_single(v.first); });
    for (const auto& [variant, handler] : entry->second) {
      if (in_double && is_single(variant))
        ++tally.skipped;
      else
        run_variant(c, variant, handler, verbose, tally);
    }
  } catch (const std::exception& e) {
    std::printf("FAIL %s: %s\n", path.c_str(), e.what());
    ++tally.failed;
  }
}

/// Runs cases in a process of its own: one whose inputs do not fit together may read where nothing is, or divide by no
/// rows. A case that ends the process has failed, and another process goes on behind it. Returns whether the last one
/// ended well.
bool run_cases(const std::vector<fs::path>& cases, int threads, bool verbose, Tally& tally) {
  for (;;) {
    const pid_t process = fork();
    if (process == 0) {
      if (threads > 0) ml::set_thread_count(threads);
      for (; tally.cases < cases.size(); ++tally.cases) run_case(cases[tally.cases], verbose, tally);
      std::exit(0);
    }
    int status = 0;
    if (process < 0 || waitpid(process, &status, 0) < 0) return std::perror("golden"), false;
    if (tally.cases == cases.size()) return status == 0;
    std::printf("FAIL %s: %s\n", cases[tally.cases].c_str(),
                WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "exit");
    ++tally.failed, ++tally.cases;
  }
}

/// Files of a folder or of all folders below it, in alphabetical order.
std::vector<fs::path> cases_below(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".safetensors") out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // lines are not lost with a process, nor written by two
  const char* chosen = std::getenv("MOTIONLANG_GOLDEN");
  const fs::path root = chosen != nullptr ? chosen : MOTIONLANG_GOLDEN_DEFAULT;
  bool verbose = false;
  int threads = 0;  // as many as the machine has
  std::vector<fs::path> cases;
  std::vector<std::string> names(argv + 1, argv + argc);
  verbose = std::erase(names, "-v") > 0;
  try {
    if (const auto t = std::find(names.begin(), names.end(), "-t"); t != names.end()) {
      if (t + 1 != names.end()) threads = std::atoi((t + 1)->c_str());
      if (threads < 1) return std::fprintf(stderr, "-t THREADS\n"), 1;
      names.erase(t, t + 2);
    }
    if (names.empty()) cases = cases_below(root);
    for (const std::string& name : names) {
      const fs::path file = root / (name + ".safetensors");
      const auto found = fs::is_regular_file(file) ? std::vector{file} : cases_below(root / name);
      cases.insert(cases.end(), found.begin(), found.end());
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  Tally& tally = shared_tally();
  const bool ended_well = run_cases(cases, threads, verbose, tally);
  std::printf("%zu cases below %s: %d passed, %d failed", cases.size(), root.c_str(), tally.passed, tally.failed);
  std::printf(tally.skipped > 0 ? " (%d variants did not apply)\n" : "\n", tally.skipped);
  return ended_well && tally.failed == 0 && !cases.empty() ? 0 : 1;
}
