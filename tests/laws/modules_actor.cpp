// ACTOR with all its networks, and the classifier that is trained on its motions.
#include <motionlang/metrics/gru_classifier.hpp>
#include <motionlang/systems/actor.hpp>

#include "module_laws.hpp"

namespace {

namespace ml = motionlang;

template <ml::ActorEncoderKind encoder, ml::ActorDecoderKind decoder>
struct SmallActor {
  template <ml::Backend B>
  static ml::Actor<B> make(ml::Philox rng) {
    return {{.njoints = 3,
             .num_classes = 4,
             .latent_dim = 8,
             .ff_size = 12,
             .num_layers = 2,
             .encoder = encoder,
             .decoder = decoder,
             .num_frames = 5,
             .max_len = 20},
            rng};
  }
};
struct SmallGruClassifier {
  template <ml::Backend B>
  static ml::GruClassifier<B> make(ml::Philox rng) {
    return {{.input_size = 6, .hidden_size = 4, .num_classes = 3}, rng};
  }
};

using E = ml::ActorEncoderKind;
using D = ml::ActorDecoderKind;

}  // namespace

TEST_CASE_TEMPLATE("laws of modules: ACTOR", M, SmallActor<E::tokens, D::transformer>, SmallActor<E::average, D::gru>,
                   SmallActor<E::gru, D::autoregressive>, SmallActor<E::fully_connected, D::fully_connected>,
                   SmallActor<E::frames, D::frames>, SmallGruClassifier) {
  laws::module_laws<M>();
}
