// Sequences of AMASS that are known to be wrong or were renamed.
#include <doctest/doctest.h>

#include <motionlang/datasets/amass_releases.hpp>

namespace ml = motionlang;
using Paths = std::vector<std::string>;

TEST_CASE("frame rates of files that say another one") {
  CHECK(ml::corrected_amass_fps("BMLhandball/S01_Expert/Trial_upper_left_001_poses.npz", 120) == 240);
  CHECK(ml::corrected_amass_fps("BMLmovi/Subject_1/20160930_50032_poses.npz", 60) == 59);
  CHECK(ml::corrected_amass_fps("MPI_mosh/20161014_50033/a_poses.npz", 60) == 59);
  CHECK(ml::corrected_amass_fps("CMU/CMU/141/141_05_poses.npz", 120) == 120);
}

TEST_CASE("a sequence has a path in each release") {
  CHECK(ml::amass_paths("BioMotionLab_NTroje/BioMotionLab_NTroje/rub001/a_poses.npz") ==
        Paths{"BioMotionLab_NTroje/BioMotionLab_NTroje/rub001/a_poses.npz", "BMLrub/BMLrub/rub001/a_poses.npz"});
  CHECK(ml::amass_paths("./HDM05/bd/a") == Paths{"./HDM05/bd/a", "./MPI_HDM05/bd/a"});
  CHECK(ml::amass_paths("SSM/a/MPI_Limits") ==
        Paths{"SSM/a/MPI_Limits", "SSM_synced/a/MPI_Limits", "SSM/a/PosePrior"});  // one direction at a time
  CHECK(ml::amass_paths("KIT/3/SSM_walk.npz") == Paths{"KIT/3/SSM_walk.npz"});     // whole folders only
  CHECK(ml::amass_paths("") == Paths{""});
}
