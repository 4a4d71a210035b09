// TEMOS with both kinds of networks, TMR, deterministic or not.
#include "../support/small_text_motion.hpp"
#include "module_laws.hpp"

namespace {

namespace ml = motionlang;

template <ml::TemosNetwork encoder, ml::TemosNetwork decoder, bool vae>
struct SmallTemos {
  template <ml::Backend B>
  static ml::Temos<B> make(ml::Philox rng) {
    auto c = small_text_motion::temos_config;
    c.motion_encoder = encoder;
    c.motion_decoder = decoder;
    c.vae = vae;
    return {c, rng};
  }
};
template <bool vae>
struct SmallTmr {
  template <ml::Backend B>
  static ml::Tmr<B> make(ml::Philox rng) {
    auto c = small_text_motion::tmr_config;
    c.vae = vae;
    return {c, rng};
  }
};

using N = ml::TemosNetwork;

}  // namespace

TEST_CASE_TEMPLATE("laws of modules: TEMOS and TMR", M, SmallTemos<N::transformer, N::transformer, true>,
                   SmallTemos<N::gru, N::gru, true>, SmallTemos<N::gru, N::transformer, false>,
                   SmallTemos<N::none, N::transformer, false>, SmallTmr<true>, SmallTmr<false>) {
  laws::module_laws<M>();
}
