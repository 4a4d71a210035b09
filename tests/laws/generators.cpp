// Everything random: generators that can be split, and those that shuffle.
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/nn/init.hpp>

#include "rng_laws.hpp"

namespace ml = motionlang;

TEST_CASE("laws of generators") {
  for (std::uint64_t seed : {0u, 1u, 123456789u}) {
    laws::rng_laws(ml::Philox{.seed = seed});
    laws::independence_law(ml::Philox{.seed = seed});
    laws::rng_laws(ml::Philox{.seed = seed}.split("part").split(seed));
  }
  laws::rng_laws(ml::NoInit{});
}

TEST_CASE("laws of shufflers") {
  laws::shuffler_laws(ml::PythonRandom(5));
  laws::shuffler_laws(ml::NumpyRandom(5));
  laws::shuffler_laws(ml::FirstWins{});
}
