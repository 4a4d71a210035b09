// index, search and judge by several processes under mpirun: the bytes of one process. Built where MPI is installed.
// `run` starts a shell here.
#include <doctest/doctest.h>

#include "training_clips.hpp"

namespace {

struct Shared : Clips {
  /// A command line of motionlang under so many processes, 0: without mpirun. The variables make Open MPI accept the
  /// user root, and more processes than processors.
  Outcome call(int processes, const std::string& arguments) const {
    const std::string mpirun = processes == 0 ? "" : MOTIONLANG_MPIRUN " -n " + std::to_string(processes) + " ";
    return run({"-c",
                "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
                "OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe\n" +
                    mpirun + MOTIONLANG_TRAINED_PROGRAM " " + arguments},
               path);
  }
  /// Its standard output.
  std::string printed(int processes, const std::string& arguments) const {
    const Outcome o = call(processes, arguments + " > printed.txt");
    CAPTURE(arguments);
    CAPTURE(processes);
    REQUIRE_MESSAGE(o.code == 0, o.text);
    return ml::read_file(*this / "printed.txt");
  }
};

}  // namespace

TEST_CASE("several processes index and search: the bytes of one process") {
  const Shared w;
  const std::string shards = "index . --captions captions.tsv --shard-mib 0.03125 --stride 0.05 --threads 1 -o ",
                    file = "index . --threads 1 -o ";
  const std::string made = w.printed(0, shards + "alone");
  w.printed(0, file + "alone.index");
  REQUIRE(std::filesystem::exists(w / "alone/shard-00001.index"));
  for (const int processes : {1, 2, 3}) {
    const std::string out = "by" + std::to_string(processes);
    CHECK(w.printed(processes, shards + out).substr(3) == made.substr(5));
    for (const auto& entry : std::filesystem::directory_iterator(w / "alone"))
      CHECK(ml::read_file(w.path / out / entry.path().filename()) == ml::read_file(entry.path()));
    w.printed(processes, file + out + ".index");
    CHECK(ml::read_file(w / (out + ".index")) == ml::read_file(w / "alone.index"));
  }
  for (const std::string query :
       {"alone 'a person walks' --moments --json", "alone 'a person turns left' --top 3",
        "alone 'someone walks' --captions", "alone --like clip3.bvh --moments", "alone.index 'a person walks'"}) {
    const std::string answer = w.printed(0, "search " + query);
    for (const int processes : {2, 3}) CHECK(w.printed(processes, "search " + query) == answer);
  }
  std::filesystem::remove(w / "alone/shard-00001.index");
  const Outcome missing = w.call(2, "search alone walk");
  CHECK(missing.code == 1);
  CHECK_MESSAGE(contains(missing.text, "shard-00001.index is missing: shard 2 of "), missing.text);
}

TEST_CASE("several processes judge: the output of one process") {
  const Shared w;
  const std::string judge = "judge --bench own --seeds 3 --steps 2 --details --threads 1";
  const std::string alone = w.printed(0, judge);
  CHECK(contains(alone, "walk"));
  CHECK(w.printed(2, judge) == alone);
  const Outcome refused = w.call(2, "judge --compare 2");
  CHECK(refused.code == 2);
  CHECK_MESSAGE(contains(refused.text, "--compare run in one process, not in 2"), refused.text);
}
