// The golden runner: computes every case with this library and compares with the published implementations.
//
//     motionlang_golden [-v] [-t THREADS] [folder or folder/case ...]
//
// Cases lie in $MOTIONLANG_GOLDEN (default: the project's tests/golden/cases), one folder for each topic; without
// arguments all are run. One line for each case and variant: largest error relative to its tolerance (at most 1
// passes), and the output that has it; -v lists every output. Exit status 0 only if everything passed.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <motionlang/core/parallel.hpp>

#include "golden.hpp"

namespace {

namespace fs = std::filesystem;
namespace ml = motionlang;

struct Tally {
  int passed = 0, failed = 0, skipped = 0;
};

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
  print_line(ok ? "ok" : "FAIL", c, variant,
             !failure.empty() ? failure : ml::concat_text(worst_name, " ", float(worst), " of its tolerance"));
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
  const char* chosen = std::getenv("MOTIONLANG_GOLDEN");
  const fs::path root = chosen != nullptr ? chosen : MOTIONLANG_GOLDEN_DEFAULT;
  bool verbose = false;
  std::vector<fs::path> cases;
  std::vector<std::string> names(argv + 1, argv + argc);
  verbose = std::erase(names, "-v") > 0;
  try {
    if (const auto t = std::find(names.begin(), names.end(), "-t"); t != names.end()) {
      if (t + 1 == names.end()) return std::fprintf(stderr, "-t THREADS\n"), 1;
      ml::set_thread_count(std::atoi((t + 1)->c_str()));
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
  Tally tally;
  for (const fs::path& path : cases) run_case(path, verbose, tally);
  std::printf("%zu cases below %s: %d passed, %d failed", cases.size(), root.c_str(), tally.passed, tally.failed);
  std::printf(tally.skipped > 0 ? " (%d variants did not apply)\n" : "\n", tally.skipped);
  return tally.failed == 0 && !cases.empty() ? 0 : 1;
}
