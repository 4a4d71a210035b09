// Statistics, windows and token frames of TM2T.
#include <motionlang/datasets/tm2t_data.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;
using ml::Index;
using Windows = std::vector<ml::ClipWindow>;

TEST_CASE("tm2t_deviation: root and contacts twice divided by five") {
  const auto std = ml::tm2t_deviation(std::vector<double>(23, 50), 2);
  for (std::size_t i = 0; i < std.size(); ++i) CHECK(std[i] == Approx(i < 4 || i >= 19 ? 2 : 50));
  CHECK(ml::tm2t_deviation(std::vector<double>(263, 50), 22, 5, 1)[262] == Approx(10));
  CHECK_ERROR(ml::tm2t_deviation(std::vector<double>(262)), "[motionlang.shape.205]");
  CHECK_ERROR(ml::tm2t_deviation(std::vector<double>(263), 22, 0), "[motionlang.config.101]");
}

TEST_CASE("tm2t_windows: the first twice, the last of each clip not at all") {
  CHECK(ml::tm2t_windows(std::vector<Index>{3, 6, 4, 7}, 4) == Windows{{1, 0}, {1, 0}, {1, 1}, {3, 0}, {3, 1}});
  CHECK(ml::tm2t_windows(std::vector<Index>{4, 5}, 4) == Windows{{0, 0}});
  CHECK(ml::tm2t_windows(std::vector<Index>{4, 3}, 4).empty());
  CHECK(ml::tm2t_windows({}, 4).empty());
  CHECK_ERROR(ml::tm2t_windows({}, 0), "[motionlang.config.101]");
}

TEST_CASE("tm2t_token_frames: whole units from any start") {
  ml::PythonRandom random(0);
  Index last = 0;
  for (int i = 0; i < 100; ++i) {
    const auto f = ml::tm2t_token_frames(43, random);
    CHECK(f.length == 40);
    last = std::max(last, f.first);
  }
  CHECK(last == 3);
  CHECK_ERROR(ml::tm2t_token_frames(3, random), "[motionlang.config.101]");
}

TEST_CASE("TeacherForcing: from 0.9 down to 0.1") {
  const ml::TeacherForcing ratio;
  CHECK(ratio(0) == Approx(0.9));
  CHECK(ratio(35) == Approx(0.1));
  CHECK(ratio(100) == Approx(0.1));
  CHECK(ml::TeacherForcing{.epochs = 0}(0) == 0.1);
}
