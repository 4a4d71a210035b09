// How many threads are started: limits of control groups, as Linux writes them.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include <motionlang/core/processors.hpp>
#include <motionlang/file/file.hpp>

#include "../../support/temporary_folder.hpp"

namespace {

namespace ml = motionlang;

/// Files below a folder, and what is read of them.
struct Groups {
  TemporaryFolder folder;

  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder / name).parent_path());
    ml::write_file(folder / name, text);
  }
  int processors(int all) const {
    return ml::detail::ControlGroups{(folder / "root").string(), (folder / "processes").string()}.processors(all);
  }
};

}  // namespace

TEST_CASE("this machine has at least one processor") { CHECK(ml::processor_count() >= 1); }

TEST_CASE("without control groups all processors count") {
  Groups g;
  CHECK(g.processors(64) == 64);
  g.write("processes", "0::/\n");
  CHECK(g.processors(64) == 64);
  g.write("processes", "nonsense\n\n:\n");
  CHECK(g.processors(64) == 64);
}

TEST_CASE("version 2: a container is its own root") {
  Groups g;
  g.write("processes", "0::/\n");
  g.write("root/cpu.max", "200000 100000\n");
  CHECK(g.processors(64) == 2);
  CHECK(g.processors(1) == 1);
  g.write("root/cpu.max", "250000 100000\n");  // two and a half
  CHECK(g.processors(64) == 3);
  g.write("root/cpu.max", "1000 100000\n");
  CHECK(g.processors(64) == 1);
  for (const char* none : {"max 100000\n", "", "0 100000\n", "200000 0\n", "nonsense\n"}) {
    g.write("root/cpu.max", none);
    CHECK(g.processors(64) == 64);
  }
}

TEST_CASE("version 2: the group around a group counts as well") {
  Groups g;
  g.write("processes", "0::/batch/job/step\n");
  g.write("root/batch/job/step/cpu.max", "max 100000\n");
  g.write("root/batch/job/cpu.max", "400000 100000\n");
  CHECK(g.processors(64) == 4);
  g.write("root/batch/job/step/cpu.max", "300000 100000\n");
  CHECK(g.processors(64) == 3);
  g.write("root/batch/cpu.max", "100000 100000\n");
  CHECK(g.processors(64) == 1);
}

TEST_CASE("version 1: quota and period are two files") {
  Groups g;
  g.write("processes", "5:memory:/docker/1\n4:cpu,cpuacct:/docker/1\n0::/\n");
  g.write("root/cpu/cpu.cfs_quota_us",
          "600000\n");  // a container sees its own group at the top, whatever its path says
  g.write("root/cpu/cpu.cfs_period_us", "100000\n");
  CHECK(g.processors(64) == 6);
  g.write("root/cpu/cpu.cfs_quota_us", "-1\n");
  CHECK(g.processors(64) == 64);
  g.write("processes", "3:cpuset,cpuacct:/\n");
  g.write("root/cpu/cpu.cfs_quota_us", "600000\n");
  CHECK(g.processors(64) == 64);
}
