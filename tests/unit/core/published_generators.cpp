// The generators of CPython, NumPy and PyTorch. Golden cases cover the functions; here: seeds, edges, errors. The
// values for CPython were printed by CPython 3.11.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <motionlang/core/mt19937.hpp>
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/core/sort.hpp>
#include <motionlang/core/torch_random.hpp>

namespace ml = motionlang;
using ml::NumpyRandom, ml::PythonRandom, ml::TorchRandom;

namespace {

using Words = std::vector<std::uint32_t>;
using Numbers = std::vector<ml::Index>;

Words three_words(PythonRandom rng) {
  Words out;
  for (int i = 0; i < 3; ++i) out.push_back(static_cast<std::uint32_t>(rng.getrandbits(32)));
  return out;
}

}  // namespace

TEST_CASE("the Mersenne Twister gives the reference output") {  // mt19937ar.out; std::mt19937 for the other seeding
  const std::uint32_t key[] = {0x123, 0x234, 0x345, 0x456};
  ml::Mt19937 by_array{std::span<const std::uint32_t>(key)};
  CHECK(by_array() == 1067595299);
  CHECK(by_array() == 955945823);
  CHECK(by_array() == 477289528);
  ml::Mt19937 by_number(5489);
  for (int i = 0; i < 9999; ++i) by_number();
  CHECK(by_number() == 4123659995u);  // the 10000th, as the C++ standard demands of std::mt19937
  const std::vector<std::uint32_t> long_key(1000, 7);
  CHECK(ml::Mt19937{std::span<const std::uint32_t>(long_key)}() != by_array());
  const std::uint32_t zero[] = {0};
  CHECK(ml::Mt19937{std::span<const std::uint32_t>{}}() == ml::Mt19937{std::span<const std::uint32_t>(zero)}());
}

TEST_CASE("CPython: seeds of all sizes and signs") {
  CHECK(three_words(PythonRandom(0)) == Words{3626764237, 1654615998, 3255389356});
  CHECK(three_words(PythonRandom(1234)) == Words{4150886329, 3342196574, 1892932127});
  CHECK(three_words(PythonRandom(-1234)) == three_words(PythonRandom(1234)));
  CHECK(three_words(PythonRandom(4294967301)) == Words{675479763, 2085189291, 1213270837});
  CHECK(three_words(PythonRandom(9223372036854775815u)) == Words{1302938503, 2170340503, 2341271591});
  CHECK(three_words(PythonRandom(18446744073709551615u)) == Words{93740670, 1068495656, 1452108352});
  CHECK(three_words(PythonRandom(std::numeric_limits<std::int64_t>::min())) ==
        Words{2377109768, 1691753470, 4039908392});
  const std::uint32_t ten_to_the_40[] = {0, 3119866112, 1554300843, 1663693251, 29};
  CHECK(three_words(PythonRandom(std::span<const std::uint32_t>(ten_to_the_40)))[0] == 1492664192);
}

TEST_CASE("CPython: bits and integers of every width") {
  PythonRandom rng(7);
  std::vector<std::uint64_t> got;
  for (int bits : {0, 1, 31, 32, 33, 53, 64}) got.push_back(rng.getrandbits(bits));
  CHECK(got ==
        std::vector<std::uint64_t>{0, 0, 2035525362, 647892279, 5990721294, 652444394356688, 9885278224986867748u});
  rng = PythonRandom(7);
  Numbers small;
  for (int i = 0; i < 8; ++i) small.push_back(rng.randint(-5, 5));
  CHECK(small == Numbers{0, -3, 1, 5, -5, -4, 3, -4});
  rng = PythonRandom(9);
  CHECK(rng.randint(0, std::int64_t{1} << 40) == 585718914800);
  CHECK(rng.randint(0, std::int64_t{1} << 40) == 408616915370);
  CHECK_THROWS_WITH_AS(rng.getrandbits(65), doctest::Contains("[motionlang.config.101]"), ml::config_error);
  CHECK_THROWS_AS(rng.getrandbits(-1), ml::config_error);
  CHECK_THROWS_AS(rng.below(0), ml::config_error);
  CHECK_THROWS_AS(rng.randint(2, 1), ml::config_error);
  CHECK_THROWS_AS(rng.choice(0), ml::config_error);
}

TEST_CASE("CPython: gauss keeps its second number across other draws") {
  PythonRandom rng(3);
  CHECK(rng.gauss(0, 1) == doctest::Approx(0x1.83ec9371cbee0p-4).epsilon(1e-15));
  CHECK(rng.random() == 0x1.7ad586f53dadep-2);
  CHECK(rng.gauss(2, 3) == doctest::Approx(0x1.700132c8f7a56p+2).epsilon(1e-15));
  CHECK(rng.gauss(0, 1) == doctest::Approx(-0x1.1d13337bac70ap+0).epsilon(1e-15));
  rng = PythonRandom(11);
  CHECK(rng.uniform(-2, 3) == 0x1.0c2eedaa13370p-2);
}

TEST_CASE("CPython: samples on both sides of the pool's limit, shuffles") {
  PythonRandom rng(5);
  CHECK(rng.sample(21, 5) == Numbers{19, 8, 11, 16, 0});
  CHECK(rng.sample(22, 5) == Numbers{14, 7, 20, 1, 5});
  CHECK(rng.sample(85, 6) == Numbers{14, 47, 60, 31, 48, 69});
  CHECK(rng.sample(86, 6) == Numbers{13, 73, 31, 1, 27, 52});
  CHECK(rng.sample(10, 10) == Numbers{4, 2, 6, 1, 0, 7, 3, 5, 8, 9});
  CHECK(rng.sample(3, 0).empty());
  CHECK(rng.sample(0, 0).empty());
  rng = PythonRandom(5);
  CHECK(rng.sample_counts(Numbers{0, 2, 1, 3}, 3) == Numbers{3, 2, 3});
  rng = PythonRandom(5);
  std::string letters = "abcdefg";
  rng.shuffle(std::span<char>(letters));
  CHECK(letters == "gdbafce");
  CHECK_THROWS_WITH_AS(rng.sample(3, 4), doctest::Contains("[motionlang.config.101]"), ml::config_error);
  CHECK_THROWS_AS(rng.sample_counts(Numbers{1, -1}, 0), ml::config_error);
  CHECK_THROWS_AS(rng.sample_counts({}, 1), ml::config_error);
}

TEST_CASE("NumPy: ranges of one word and of two, and of nothing") {
  NumpyRandom rng(0);
  CHECK(rng.randint(5, 6) == 5);  // draws nothing
  CHECK(rng.randint(0, 3) == NumpyRandom(0).randint(0, 3));
  for (int i = 0; i < 100; ++i) {
    CHECK(rng.randint(-3, 2) >= -3);
    CHECK(rng.randint(0, std::int64_t{1} << 40) < std::int64_t{1} << 40);
    CHECK(rng.randint(std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()) <
          std::numeric_limits<std::int64_t>::max());
  }
  Numbers all = rng.permutation(50);
  std::sort(all.begin(), all.end());
  for (ml::Index i = 0; i < 50; ++i) CHECK(all[static_cast<std::size_t>(i)] == i);
  CHECK(rng.permutation(0).empty());
  CHECK(rng.choice(5, 0).empty());
  CHECK_THROWS_WITH_AS(rng.randint(3, 3), doctest::Contains("[motionlang.config.101]"), ml::config_error);
  CHECK_THROWS_AS(rng.permutation(-1), ml::config_error);
  CHECK_THROWS_AS(rng.choice(3, 4), ml::config_error);
}

TEST_CASE("PyTorch: the low 32 bits of the seed count") {
  std::vector<float> a(20), b(20), c(20);
  TorchRandom(5).normal(std::span<float>(a));
  TorchRandom((std::uint64_t{9} << 32) + 5).normal(std::span<float>(b));
  TorchRandom(6).normal(std::span<float>(c));
  CHECK(a == b);
  CHECK(a != c);
  std::vector<float> known(3 * 16);  // torch.manual_seed(0) starts with these
  TorchRandom(0).normal(std::span<float>(known));
  CHECK(known[0] == doctest::Approx(-1.12584).epsilon(1e-5));
  CHECK(known[1] == doctest::Approx(-1.15236).epsilon(1e-5));
  CHECK(known[2] == doctest::Approx(-0.25058).epsilon(1e-5));
}

TEST_CASE("PyTorch: the spare number survives large draws; an empty draw takes nothing") {
  std::vector<double> small(1), large(16), nothing, pair(2);
  TorchRandom rng(4), reference(4);
  reference.normal(std::span<double>(pair));
  rng.normal(std::span<double>(small));
  CHECK(small[0] == pair[0]);
  rng.normal(std::span<double>(large));
  rng.normal(std::span<double>(nothing));
  rng.normal(std::span<double>(small));
  CHECK(small[0] == pair[1]);
}
