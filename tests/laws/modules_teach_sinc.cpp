// TEACH and SINC, with and without the modules that only some checkpoints have.
#include "../support/small_teach_sinc.hpp"
#include "module_laws.hpp"

namespace {

namespace ml = motionlang;

template <bool all>
struct SmallTeach {
  template <ml::Backend B>
  static ml::Teach<B> make(ml::Philox rng) {
    auto c = small_teach_sinc::teach_config;
    c.unused_encoder = c.motion_encoder = all;
    return {c, rng};
  }
};
struct SmallSinc {
  template <ml::Backend B>
  static ml::Sinc<B> make(ml::Philox rng) {
    return {small_teach_sinc::sinc_config, rng};
  }
};

}  // namespace

TEST_CASE_TEMPLATE("laws of modules: TEACH and SINC", M, SmallTeach<true>, SmallTeach<false>, SmallSinc) {
  laws::module_laws<M>();
}
